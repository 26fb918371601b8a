"""Lesson 01, second exercise, as it is graded: in a namespace that nobody can know."""

from __future__ import annotations

from autograder.exams.visible.night_watch import build
from autograder.runs.inputs import generator

_draw = generator('night_watch', 'time and place')
exam = build(
    seconds=_draw.randrange(16, 25),
    phase_s=round(_draw.uniform(0.02, 0.23), 3),
    namespace='/' + ''.join(_draw.choices('bcdfghklmnprst', k=6)),
)
