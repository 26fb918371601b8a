"""
Tries: hand in a notebook without the check cells, so that nothing can fail.

Stopped by: the notebook is rebuilt from the release; only the texts of answers survive
Deserves: 0
Flag: is missing
"""

from tests.attacks.handing_in import checks


def notebook(solved, blank):
    gone = list(checks(blank))
    blank['cells'] = [one for one in blank['cells'] if one not in gone]
    return blank
