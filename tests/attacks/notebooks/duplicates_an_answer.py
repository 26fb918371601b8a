"""
Tries: hand in several answers to one question and hope for the best of them.

Stopped by: the first one counts, and that is said
Deserves: 35
Flag: occurs 2 times
"""

from tests.attacks.handing_in import cell


def notebook(solved, blank):
    right = cell(solved, 'temperature_publisher')
    wrong = {**right, 'id': 'first', 'source': '%%node temp_publisher\n'}
    solved['cells'].insert(0, wrong)
    return solved
