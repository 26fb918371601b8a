"""
Wait for the network of the student's sandbox.

Bubblewrap reports the first process of the sandbox before that process has brought up the loopback
interface, and on a busy machine the probe can start earlier.  Fast DDS lists the interfaces once:
a participant that is created too early never receives anything, and the probe would see no node.

This file imports nothing from this project.
"""

from __future__ import annotations

import fcntl
import select
import socket
import struct

ADDRESS, INTERFACE = '127.0.0.1', b'lo'
SIOCGIFFLAGS, IFF_UP = 0x8913, 0x1  # netdevice(7)
IFREQ = struct.Struct('16sh22x')
# Multicast groups for changes of interfaces, addresses and routes: rtnetlink(7).
RTMGRP_LINK, RTMGRP_IPV4_IFADDR, RTMGRP_IPV4_ROUTE = 0x1, 0x10, 0x40
# A netlink port id above all process ids. By default, Linux uses the process id, and both the
# probe and bubblewrap can be process 1 of their namespaces. Bubblewrap fails if id 1 is taken.
PORT = 1 << 30
NEWS = RTMGRP_LINK | RTMGRP_IPV4_IFADDR | RTMGRP_IPV4_ROUTE


def works() -> bool:
    """Return whether the loopback interface has its address, which is set first, and is up."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as datagrams:
        try:
            datagrams.bind((ADDRESS, 0))
            asked = IFREQ.pack(INTERFACE, 0)
            _, flags = IFREQ.unpack(fcntl.ioctl(datagrams, SIOCGIFFLAGS, asked))
        except OSError:
            return False
    return bool(flags & IFF_UP)


def wait() -> None:
    """
    Wait until the loopback interface is up.

    :raises SystemExit: if the grader closes standard input
    """
    if works():
        return
    waits = select.poll()
    waits.register(0, 0)  # poll(2) always reports a hang-up
    with socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE) as news:
        news.bind((PORT, NEWS))
        waits.register(news, select.POLLIN)
        while not works():  # check again after the socket is bound, and after each notification
            if 0 in dict(waits.poll()):
                raise SystemExit
            news.recv(1 << 16)
