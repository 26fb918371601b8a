"""
Tries: sleep where the virtual clock does not see it, by the number of the system call.

Stopped by: 5 s of the whole run in which nobody computes
Deserves: 0
Ends: waits_outside
"""

import ctypes
import platform

NANOSLEEP = {'x86_64': 35, 'aarch64': 101}[platform.machine()]

ctypes.CDLL('libc.so.6').syscall(NANOSLEEP, (ctypes.c_int64 * 2)(1000, 0), None)
