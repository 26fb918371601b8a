"""
Tries: read the environment, command line, memory and open files of every process it can see.

Stopped by: a pid namespace, and a launcher that starts with an empty environment
Deserves: 0
"""

import glob
import os

own = str(os.getpid())
for folder in glob.glob('/proc/[0-9]*'):
    if folder.endswith('/' + own) or folder == '/proc/self':
        continue
    for name in ('environ', 'cmdline', 'maps'):
        try:
            with open(f'{folder}/{name}', 'rb') as file:
                text = file.read().replace(b'\0', b' ').decode(errors='replace')
        except OSError:
            continue
        if any(word in text for word in ('SECRET', 'autograder', 'hidden', 'gradebook')):
            print('FOUND', folder, name, text[:500])
    try:
        for descriptor in os.listdir(f'{folder}/fd'):
            print('descriptor', os.readlink(f'{folder}/fd/{descriptor}'))
    except OSError:
        pass
