"""
Tries: break the compiler with an expression that is nested too deeply.

Stopped by: answers are compiled in the sandbox only
Deserves: 35
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    one = cell(solved, 'temperature_publisher')
    one['source'] += '\nx = ' + '-' * 30_000 + '1\ny = ' + '(' * 9_000 + ')' * 9_000
    return solved
