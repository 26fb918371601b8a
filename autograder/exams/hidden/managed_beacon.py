"""Hidden exam of lesson 06, part 2: in a secret namespace and for a secret time."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.managed_beacon import build

_draw = generator('managed_beacon', 'place and time')
exam = build(
    namespace='/' + ''.join(_draw.choices('bdghjklmnprstvz', k=6)),
    seconds=float(_draw.randint(21, 23)),  # longer than a text that is sent sign by sign
)
