"""Lesson 03, part 3, as it is graded: those who come late come when nobody can know."""

from __future__ import annotations

from autograder.exams.visible.courier import build
from autograder.runs.inputs import generator

_draw = generator('courier', 'moments')
exam = build(alone_s=_draw.choice((7.0, 11.0, 12.0)), between_s=_draw.choice((4.0, 5.0, 6.0)))
