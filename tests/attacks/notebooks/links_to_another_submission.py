"""
Tries: hand in a symbolic link to another student's notebook.

Stopped by: only regular files are opened, and no link is followed
Deserves: 0
Flag: a symbolic link
"""

import os

from tests.attacks.handing_in import ASSIGNMENT, NOTEBOOK


def hand_in(student, solved, blank):
    place = student / ASSIGNMENT
    place.mkdir(parents=True)
    os.symlink(f'../../ada/{ASSIGNMENT}/{NOTEBOOK}', place / NOTEBOOK)
