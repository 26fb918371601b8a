"""
Tries: fill every writable folder, with bytes and with a flood of empty files.

Stopped by: writable folders of a fixed size, and a watchdog that counts files
Deserves: 0
Flag: inode_limit
"""

import itertools

for folder in ('/tmp', '/dev/shm'):
    try:
        with open(f'{folder}/big', 'wb') as file:
            while True:
                file.write(b'x' * (1 << 20))
    except OSError:
        pass
for number in itertools.count():
    open(f'/tmp/home/{number}', 'w').close()
