"""
Tries: unlock the check cells and let them say the score.

Stopped by: the notebook is rebuilt from the release; only the texts of answers survive
Deserves: 0
Flag: has different text
Flag: a different value of locked
"""

from tests.attacks.handing_in import checks


def notebook(solved, blank):
    for one in checks(blank):
        one['metadata'].update(editable=True, deletable=True)
        one['metadata']['nbgrader'].update(locked=False, solution=True)
        one['source'] = '15.0'
    return blank
