"""
Tries: create files endlessly where only the total size is limited.

Stopped by: the watchdog counts the files of both writable folders
Deserves: 0
Flag: inode_limit
"""

import itertools

for number in itertools.count():
    open(f'/dev/shm/{number}', 'w').close()
