"""
Tries: hold a thread in the state of a wait for a disk, by ``clone(CLONE_VFORK)`` with a child that
    pauses.

Stopped by: 5 s of the whole run in which nobody computes
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
