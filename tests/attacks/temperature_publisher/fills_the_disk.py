"""
Tries: fill every writable folder, with bytes and with a flood of empty files.

Deserves: 0
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
