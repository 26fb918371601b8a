"""
Tries: write the names of other students and their grades wherever a name could be taken from.

Stopped by: the student is the folder, and nothing else
Deserves: 0
"""

import json

from tests.attacks.handing_in import lay_out


def hand_in(student, solved, blank):
    blank['metadata'].update(student='ada', authors=[{'name': 'ada'}])
    for one in blank['cells']:
        one['metadata'].setdefault('nbgrader', {})['student'] = 'ada'
    place = lay_out(student, blank)
    (place / 'ada.ipynb').write_text(json.dumps(blank))
    (place / 'gradebook.csv').write_text('student,score\nada,0\n')
