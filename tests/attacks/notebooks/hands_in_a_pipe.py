"""
Tries: hand in a pipe, from which the grader would read for ever.

Stopped by: only regular files are opened
Deserves: 0
Flag: something else
"""

import os

from tests.attacks.handing_in import ASSIGNMENT, NOTEBOOK


def hand_in(student, solved, blank):
    place = student / ASSIGNMENT
    place.mkdir(parents=True)
    os.mkfifo(place / NOTEBOOK)
    os.mkfifo(place / 'timestamp.txt')
