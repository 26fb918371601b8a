"""
Tries: hand in a folder that is called like the notebook.

Stopped by: only regular files are opened
Deserves: 0
Flag: something else
"""

from tests.attacks.handing_in import ASSIGNMENT, NOTEBOOK


def hand_in(student, solved, blank):
    (student / ASSIGNMENT / NOTEBOOK / NOTEBOOK).mkdir(parents=True)
