"""
Tries: find the hidden exams, the gradebook, the course secret or another submission on the
    disk.

Stopped by: hidden exams, gradebook and submissions are not mounted
Deserves: 0
"""

import os

for folder, _, names in os.walk('/'):
    if folder.startswith(('/proc', '/sys', '/usr')) or 'site-packages' in folder:
        continue
    for name in names:
        path = os.path.join(folder, name)
        if '/exams/' in path or name in ('gradebook.db', 'course_secret'):
            print('FOUND', path)
        if name.endswith(('.py', '.json', '.db', '.ipynb', '.xml')):
            try:
                with open(path, errors='replace') as file:
                    text = file.read()
            except OSError:
                continue
            if 'CANARY-7f3a9c' in text and not path.startswith('/submission'):
                print('FOUND', path, text[:2000])
