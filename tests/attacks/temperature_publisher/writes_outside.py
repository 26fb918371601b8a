"""
Tries: change its own submission, the Python it runs in, the system and kernel settings.

Stopped by: everything but two temporary folders is mounted read-only
Deserves: 0
"""

import os
import sys

for path in (
    '/submission/temp_publisher.py',
    '/submission/new.py',
    '/grader/inside/run_node.py',
    f'{sys.prefix}/planted.py',
    f'{os.path.dirname(os.__file__)}/site-packages/planted.pth',
    '/usr/lib/planted',
    '/planted',
    '/dev/planted',
    '/etc/planted',
    '/proc/sys/kernel/core_pattern',
    '/proc/sys/kernel/hostname',
):
    try:
        with open(path, 'a') as file:
            file.write('x')
    except OSError:
        continue
    print('WROTE', path)
