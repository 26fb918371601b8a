"""Hidden exam of lesson 02, part 5: more pictures, with secret names."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.inspector import build

_draw = generator('inspector', 'pictures')
_drawn = [''.join(_draw.choices('bcdfghjklmnprstvwz', k=6)) for _ in range(9)]
# A repeated picture, an earlier one and one with an empty name are ordinary inputs.
exam = build([*_drawn[:3], _drawn[2], '', _drawn[0], *_drawn[3:]], burst=4)
