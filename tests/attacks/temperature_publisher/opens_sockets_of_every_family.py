"""
Tries: open sockets of every family and kind that the kernel has, and change its own network.

Stopped by: a system-call filter of four families, and no capability in the network namespace
Deserves: 0
"""

import socket
import struct

for family in range(1, 50):
    for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM, socket.SOCK_RAW, socket.SOCK_SEQPACKET):
        try:
            socket.socket(family, kind).close()
        except OSError:
            continue
        harmless = family in (1, 16) or (family in (2, 10) and kind != socket.SOCK_RAW)
        if not harmless:
            print('ESCAPED socket', family, kind)
netlink = socket.socket(16, socket.SOCK_RAW, 0)
netlink.bind((0, 0))
# RTM_NEWLINK: a dummy interface
body = struct.pack('=BxHiII', 0, 0, 0, 1, 1) + struct.pack('=HH4s', 8, 3, b'evil')
netlink.send(struct.pack('=IHHII', 16 + len(body), 16, 0x605, 1, 0) + body)
answer = netlink.recv(4096)
if struct.unpack_from('=i', answer, 16)[0] == 0:
    print('ESCAPED netlink')
for protocol in (9, 15, 21):
    try:
        found = socket.socket(16, socket.SOCK_RAW, protocol)
        found.bind((0, 1))
    except OSError:
        continue
    found.settimeout(0.2)
    try:
        print('REACHED netlink', protocol, found.recv(100))
    except OSError:
        pass
