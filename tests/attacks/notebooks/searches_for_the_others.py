"""
Tries: look for the submissions of others, the gradebook and the hidden exams from inside of an
    answer, and print them.

Stopped by: none of them is mounted where the answer runs
Deserves: 35
"""

from tests.attacks.handing_in import cell

SEARCH = """%%node temp_publisher
import os

for folder, _, names in os.walk('/'):
    if folder.startswith(('/proc', '/sys', '/usr', '/submission')) or 'site-packages' in folder:
        continue
    for name in names:
        path = os.path.join(folder, name)
        if any(word in path for word in ('submitted', 'gradebook', '/exams/', 'course_secret')):
            print('FOUND', path)
        try:
            with open(path, errors='replace') as file:
                if 'CANARY-' + '7f3a9c' in file.read(1 << 20):
                    print('FOUND', path)
        except OSError:
            continue
"""


def notebook(solved, blank):
    cell(solved, 'temperature_publisher')['source'] = SEARCH
    return solved
