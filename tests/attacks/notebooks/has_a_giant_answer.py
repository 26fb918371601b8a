"""
Tries: hand in an answer that no compiler and no database likes.

Stopped by: an answer has at most 64 KiB
Deserves: 35
Flag: at most 64 KiB
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    cell(solved, 'temperature_publisher')['source'] += '\n' + 'x = ' + '(' * 5_000_000
    return solved
