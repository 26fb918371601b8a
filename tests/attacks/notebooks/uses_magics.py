"""
Tries: put shell commands and magics below and above the answer.

Stopped by: an answer is a file: nothing expands a magic in it
Deserves: 35
"""

from tests.attacks.handing_in import PAYLOAD, cell


def notebook(solved, blank):
    one = cell(solved, 'temperature_publisher')
    lines = ['!touch {PAYLOAD}', '%run -m os', '%%bash', f'touch {PAYLOAD}', '%system id']
    one['source'] = one['source'] + '\n' + '\n'.join(lines).replace('{PAYLOAD}', str(PAYLOAD))
    return solved
