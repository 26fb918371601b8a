"""
Tries: hand in under a name that is made of terminal codes and line ends.

Stopped by: a student id has letters, digits and . _ - @; others are reported and not recorded
Deserves: 0
Flag: expected a student id
"""

from tests.attacks.handing_in import lay_out

STUDENT = '\x1b[2Jred\nada,40'


def hand_in(student, solved, blank):
    lay_out(student, solved)
