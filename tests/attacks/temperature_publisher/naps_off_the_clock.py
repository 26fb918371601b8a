"""
Tries: use neither processor time nor much virtual time, by naps where the clock does not see them.

Stopped by: a limit of 0.3 s per run in which all threads sleep outside the virtual clock
Deserves: 0
Ends: waits_outside
"""

import ctypes
import platform
import time

NANOSLEEP = {'x86_64': 35, 'aarch64': 101}[platform.machine()]

system = ctypes.CDLL('libc.so.6').syscall
while True:
    system(NANOSLEEP, (ctypes.c_int64 * 2)(0, 200_000_000), None)
    time.sleep(0.001)
