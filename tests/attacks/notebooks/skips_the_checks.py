"""
Tries: mark the check cells with tags on which nbgrader and Jupyter do not run them, which
    gives full points there.

Stopped by: the notebook is rebuilt from the release; only the texts of answers survive
Deserves: 0
Flag: has the tags
"""

from tests.attacks.handing_in import checks


def notebook(solved, blank):
    for one in checks(blank):
        one['metadata']['tags'] = ['skip-execution', 'raises-exception', 'remove_cell']
    return blank
