"""
Tries: hand in every check several times.

Stopped by: the notebook is rebuilt from the release; only the texts of answers survive
Deserves: 0
Flag: occurs 4 times
"""

from tests.attacks.handing_in import checks


def notebook(solved, blank):
    blank['cells'] += [dict(one) for one in checks(blank) for _ in range(3)]
    return blank
