"""Lesson 06, part 2, as it is graded: in a namespace and at a moment nobody can know."""

from __future__ import annotations

from autograder.exams.visible.managed_beacon import build
from autograder.runs.inputs import generator

_draw = generator('managed_beacon', 'place and time')
exam = build(
    namespace='/' + ''.join(_draw.choices('bdghjklmnprstvz', k=6)),
    seconds=float(_draw.randint(8, 9)),
    phase_s=round(_draw.uniform(0.02, 0.23), 3),
)
