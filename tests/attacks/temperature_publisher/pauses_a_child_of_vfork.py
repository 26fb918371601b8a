"""
Tries: keep a thread in disk sleep, by ``clone(CLONE_VFORK)`` with a child that pauses.

Stopped by: a limit of 2.5 s per run in which no process computes
Deserves: 0
Ends: waits_outside
"""

import ctypes
import platform
import signal

CLONE = {'x86_64': 56, 'aarch64': 220}[platform.machine()]
CLONE_VFORK = 0x4000

libc = ctypes.CDLL('libc.so.6')
if libc.syscall(CLONE, CLONE_VFORK | signal.SIGCHLD, 0, 0, 0, 0) == 0:
    libc.pause()
