"""
Tries: use files and sockets that the grader may have left open for it.

Stopped by: all descriptors but the three standard ones are closed at the start
Deserves: 0
"""

import os

for descriptor in range(3, 256):
    try:
        target = os.readlink(f'/proc/self/fd/{descriptor}')
    except OSError:
        continue
    if '/proc/' not in target:
        print('FOUND', descriptor, target)
