"""
Tries: add cells of its own that nbgrader would count.

Stopped by: the notebook is rebuilt from the release; only the texts of answers survive
Deserves: 0
Flag: the release has no cell with the grade id
"""

from tests.attacks.handing_in import code


def notebook(solved, blank):
    for number in range(3):
        bonus = code('1000.0')
        bonus['metadata']['nbgrader'] = {
            'grade_id': f'bonus_{number}',
            'grade': True,
            'solution': False,
            'locked': True,
            'points': 1000,
            'schema_version': 3,
        }
        blank['cells'].append(bonus)
    return blank
