"""
Tries: use files and sockets that the grader may have left open for it.

Stopped by: all descriptors but the three standard ones and those of the virtual clock are closed
    at the start
Deserves: 0
"""

import os

CLOCK = {int(os.environ['VIRTUAL_CLOCK']), *range(128, 256)}

for descriptor in sorted({*range(3, 256)} - CLOCK):
    try:
        target = os.readlink(f'/proc/self/fd/{descriptor}')
    except OSError:
        continue
    if '/proc/' not in target:
        print('FOUND', descriptor, target)
