"""Hidden exam of lesson 02, part 5: more pictures, and secret names of them."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.inspector import build

_draw = generator('inspector', 'pictures')
_drawn = [''.join(_draw.choices('bcdfghjklmnprstvwz', k=6)) for _ in range(9)]
# The same picture again, an earlier one, and an empty name are pictures like any other.
exam = build([*_drawn[:3], _drawn[2], '', _drawn[0], *_drawn[3:]], burst=4)
