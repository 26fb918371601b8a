"""
Tries: put zero bytes, form feeds, half surrogates and writing directions into an answer.

Stopped by: the text is what it is; only the sandbox compiles it
Deserves: 35
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    one = cell(solved, 'temperature_publisher')
    one['source'] += '\n\x00\x0c\ud800\u202e\ufeff'
    return solved
