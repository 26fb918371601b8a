"""
Tries: name the file so that a shell, a pattern or a log would act on it.

Stopped by: file names are no commands; they are quoted and cut where they are shown
Deserves: 50
Flag: which was graded instead
"""

from tests.attacks.handing_in import lay_out


def hand_in(student, solved, blank):
    lay_out(student, solved, '-rf $(touch an-attack) *;\n\x1b[2J<b>.ipynb')
