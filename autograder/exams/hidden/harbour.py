"""Lesson 01, first exercise, as it is graded: longer, at a moment nobody can know."""

from __future__ import annotations

from autograder.exams.visible.harbour import build
from autograder.runs.inputs import generator

_draw = generator('harbour', 'time')
exam = build(seconds=_draw.randrange(14, 20), phase_s=round(_draw.uniform(0.02, 0.23), 3))
