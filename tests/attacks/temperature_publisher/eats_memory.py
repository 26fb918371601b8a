"""
Tries: use all memory, from several processes, each below its own limit.

Stopped by: the watchdog sums the memory of all processes of a sandbox
Deserves: 0
Ends: memory_limit
Flag: ended by the grader
"""

import os
import time

for _ in range(7):
    if os.fork() == 0:
        break
held = []
try:
    while len(held) < 60:
        held.append(bytearray(b'x') * (10 << 20))
except MemoryError:
    pass
time.sleep(100)
