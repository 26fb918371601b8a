"""
Tries: sleep unnoticed by the virtual clock, with a direct system call.

Stopped by: a limit of 0.3 s per run in which all threads sleep outside the virtual clock
Deserves: 0
Ends: waits_outside
"""

import ctypes
import platform

NANOSLEEP = {'x86_64': 35, 'aarch64': 101}[platform.machine()]

ctypes.CDLL('libc.so.6').syscall(NANOSLEEP, (ctypes.c_int64 * 2)(1000, 0), None)
