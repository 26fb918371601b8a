"""
Tries: hand in a link to another student's folder.

Stopped by: only real folders are entered
Deserves: 0
Flag: a link or a file
"""

import os

from tests.attacks.handing_in import ASSIGNMENT


def hand_in(student, solved, blank):
    student.mkdir()
    os.symlink(f'../ada/{ASSIGNMENT}', student / ASSIGNMENT)
