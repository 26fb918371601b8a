"""
Tries: make texts of the checks and code of the texts.

Stopped by: the notebook is rebuilt from the release; only the texts of answers survive
Deserves: 0
Flag: is a 'raw' cell
"""

from tests.attacks.handing_in import marked


def notebook(solved, blank):
    for one in marked(blank):
        one['cell_type'] = 'raw'
    return blank
