"""
Tries: get privileges back with new namespaces, mounts, ptrace, keyrings and raw sockets.

Stopped by: no capability, a system-call filter, and user namespaces forbidden
Deserves: 0
"""

import ctypes
import os
import socket

libc = ctypes.CDLL(None, use_errno=True)
for name, flag in (('user', 0x10000000), ('mount', 0x20000), ('net', 0x40000000)):
    if libc.unshare(flag) == 0:
        print('ESCAPED unshare', name)
if libc.mount(b'none', b'/tmp', b'tmpfs', 0, None) == 0:
    print('ESCAPED mount')
if libc.ptrace(16, 1, 0, 0) == 0:
    print('ESCAPED ptrace')
if libc.syscall(250, 0, -3, 0) > 0:
    print('ESCAPED keyctl')
if libc.syscall(319, b'hidden', 0) > 0:
    print('ESCAPED memfd_create')
for family in (17, 40, 38, 31):
    try:
        socket.socket(family, socket.SOCK_RAW if family == 17 else socket.SOCK_STREAM)
    except OSError:
        continue
    print('ESCAPED socket family', family)
try:
    os.setuid(0)
except OSError:
    pass
else:
    print('ESCAPED setuid')
