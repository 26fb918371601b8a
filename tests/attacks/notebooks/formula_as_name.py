"""
Tries: hand in under a name that is made of formulas for a spreadsheet.

Stopped by: a student id has letters, digits and . _ - @; others are reported and not recorded
Deserves: 0
Flag: expected a student id
"""

from tests.attacks.handing_in import lay_out

STUDENT = "=cmd|' -C calc'!A0"


def hand_in(student, solved, blank):
    lay_out(student, solved)
