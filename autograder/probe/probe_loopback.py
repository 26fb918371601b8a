"""
Wait for the network of the student's sandbox.

Bubblewrap reports the process of the sandbox before this process has switched on the loopback
interface, and on a busy machine a probe can be faster.  Fast DDS looks for interfaces once: a
participant that is created too early never receives anything, and the probe would see no node.

This file imports nothing of this project: only its text enters the probe's sandbox.
"""

from __future__ import annotations

import fcntl
import select
import socket
import struct

ADDRESS, INTERFACE = '127.0.0.1', b'lo'
SIOCGIFFLAGS, IFF_UP = 0x8913, 0x1  # netdevice(7)
IFREQ = struct.Struct('16sh22x')
# News of interfaces, their addresses and routes, as one group each: rtnetlink(7).
RTMGRP_LINK, RTMGRP_IPV4_IFADDR, RTMGRP_IPV4_ROUTE = 0x1, 0x10, 0x40
# Beyond all process ids. Left to choose, Linux takes that of the process, which is 1 for the probe
# and for bubblewrap; the second of them would not get what it expects, and bubblewrap gives up.
PORT = 1 << 30
NEWS = RTMGRP_LINK | RTMGRP_IPV4_IFADDR | RTMGRP_IPV4_ROUTE


def works() -> bool:
    """Return whether the loopback interface is up and has its address, which it gets first."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as datagrams:
        try:
            datagrams.bind((ADDRESS, 0))
            asked = IFREQ.pack(INTERFACE, 0)
            _, flags = IFREQ.unpack(fcntl.ioctl(datagrams, SIOCGIFFLAGS, asked))
        except OSError:
            return False
    return bool(flags & IFF_UP)


def wait() -> None:
    """Wait until the loopback interface is up, or the grader has closed standard input."""
    if works():
        return
    waits = select.poll()
    waits.register(0, 0)  # its end is told without being asked for
    with socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE) as news:
        news.bind((PORT, NEWS))
        waits.register(news, select.POLLIN)
        while not works():  # asked after each piece of news, and once it would be heard
            if 0 in dict(waits.poll()):
                raise SystemExit
            news.recv(1 << 16)
