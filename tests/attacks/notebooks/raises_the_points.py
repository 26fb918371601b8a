"""
Tries: make every check worth a thousand points.

Stopped by: the notebook is rebuilt from the release; only the texts of answers survive
Deserves: 0
Flag: a different value of points
"""

from tests.attacks.handing_in import checks


def notebook(solved, blank):
    for one in checks(blank):
        one['metadata']['nbgrader']['points'] = 1000
    return blank
