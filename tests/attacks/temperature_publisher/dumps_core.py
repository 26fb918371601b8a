"""
Tries: leave core files full of memory on the disk of the host.

Stopped by: a core limit of zero, and no privilege to change where cores go
Deserves: 0
"""

import os
import resource

try:
    resource.setrlimit(resource.RLIMIT_CORE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    print('ESCAPED the core limit')
except (OSError, ValueError):
    pass
try:
    with open('/proc/sys/kernel/core_pattern', 'w') as file:
        file.write('|/tmp/x')
    print('WROTE core_pattern')
except OSError:
    pass
os.abort()
