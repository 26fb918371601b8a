"""
Tries: become a different user with set-uid programs, one of its own, and setuid().

Stopped by: no-new-privileges, no capability, an unprivileged uid
Deserves: 0
"""

import glob
import os
import shutil
import stat
import subprocess

own = os.getuid()
for name in ('setuid', 'setgid'):
    try:
        getattr(os, name)(0)
    except OSError:
        continue
    print('ESCAPED', name)
for path in glob.glob('/usr/bin/*') + glob.glob('/usr/sbin/*'):
    try:
        if os.stat(path).st_mode & stat.S_ISUID and os.path.basename(path) in ('su', 'sudo'):
            done = subprocess.run([path, '-c', 'id -u'], capture_output=True, timeout=3, text=True)
            if done.stdout.strip() == '0':
                print('ESCAPED', path)
    except (OSError, subprocess.TimeoutExpired):
        continue
shutil.copy('/bin/sh', '/tmp/shell')
os.chmod('/tmp/shell', 0o6755)
found = subprocess.run(['/tmp/shell', '-p', '-c', 'id -u'], capture_output=True, text=True).stdout
if found.strip() not in ('', str(own)):
    print('ESCAPED', found)
