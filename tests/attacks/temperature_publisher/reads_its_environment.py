"""
Tries: look for secrets in its environment, its arguments, the kernel's keys and the table of
 mounts.

Stopped by: an environment that the grader builds from scratch; the table of mounts shows paths,
 but no contents
Deserves: 0
"""

import glob
import os

texts = [repr(dict(os.environ))]
for path in (
    '/proc/self/environ',
    '/proc/1/environ',
    '/proc/self/cmdline',
    '/proc/1/cmdline',
    '/proc/self/mountinfo',
    '/proc/keys',
    '/proc/kcore',
    '/proc/net/unix',
    '/proc/self/auxv',
    *glob.glob('/sys/kernel/**', recursive=True)[:500],
):
    try:
        with open(path, 'rb') as file:
            texts.append(file.read(1 << 20).decode(errors='replace'))
    except OSError:
        continue
for text in texts:
    for word in ('CANARY-' + '7f3a9c', 'COURSE_SECRET', 'gradebook.db'):
        if word in text:
            print('FOUND', word)
