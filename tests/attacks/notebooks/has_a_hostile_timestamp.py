"""
Tries: hand in with a time that no program can read.

Stopped by: a broken time is left out
Deserves: 50
"""

from tests.attacks.handing_in import lay_out


def hand_in(student, solved, blank):
    place = lay_out(student, solved)
    (place / 'timestamp.txt').write_text('999999999999-99-99 ' + '9' * 100_000)
