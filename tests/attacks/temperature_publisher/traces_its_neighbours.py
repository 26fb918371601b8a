"""
Tries: read and write the memory of the process that started it, and of every other one.

Stopped by: a pid namespace, and a filter without ptrace and its relatives
Deserves: 0
"""

import ctypes
import os

libc = ctypes.CDLL(None, use_errno=True)
for pid in (1, 2, os.getppid()):
    if pid in (0, os.getpid()):
        continue
    if libc.ptrace(16, pid, 0, 0) == 0:
        print('ESCAPED ptrace', pid)
    for name in ('mem', 'environ', 'maps'):
        try:
            with open(f'/proc/{pid}/{name}', 'rb') as file:
                text = file.read(100)
        except OSError:
            continue
        if b'CANARY' in text or b'SECRET' in text:
            print('FOUND', pid, name)
    try:
        os.kill(pid, 0)
        if pid != 1:
            os.kill(pid, 9)
    except OSError:
        pass
