"""
Tries: plant files that Python and the shell read when they start, for the next run.

Stopped by: each run has a separate sandbox with an empty home directory
Deserves: 15
"""

import os
import site

import honest

home = os.path.expanduser('~')
print(sorted(os.listdir(home)))
if any(name in os.listdir(home) for name in ('.local', '.bashrc', '.pythonstartup')):
    print('FOUND what an earlier run has left')
packages = site.getusersitepackages()
os.makedirs(packages, exist_ok=True)
for path in (f'{packages}/usercustomize.py', f'{packages}/x.pth', f'{home}/.bashrc'):
    with open(path, 'w') as file:
        file.write('import os; os._exit(0)')
honest.main()
