"""
Tries: allocate memory that is private to no process: shared, anonymous, in many mappings.

Stopped by: the watchdog sums all resident memory; memory files are forbidden
Deserves: 0
Ends: memory_limit
Flag: ended by the grader
"""

import mmap

held = []
try:
    while len(held) < 40:
        held.append(mmap.mmap(-1, 64 << 20, flags=mmap.MAP_SHARED | mmap.MAP_ANONYMOUS))
        held[-1][:] = b'x' * (64 << 20)
except (OSError, MemoryError):
    pass
while True:
    pass
