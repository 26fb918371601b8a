"""
Tries: bring settings, plug-ins and modules that a tool would load from beside the notebook.

Stopped by: only the notebook's own file is read
Deserves: 0
"""

from tests.attacks.handing_in import PAYLOAD, lay_out


def hand_in(student, solved, blank):
    place = lay_out(student, blank)
    text = f'open({str(PAYLOAD)!r}, "w"); c = get_config(); c.SaveGrades.enabled = False'
    for name in (
        'nbgrader_config.py',
        'conftest.py',
        'sitecustomize.py',
        'autograder.py',
        'rclpy.py',
    ):
        (place / name).write_text(text)
    (place / 'gradebook.db').write_bytes(b'SQLite format 3\x00')
    (place / 'feedback').mkdir()
    (place / '.ipynb_checkpoints').mkdir()
