"""Lesson 03, part 3, as it is graded: those who come late come when nobody can know."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.courier import build

_draw = generator('courier', 'moments')
# None lets a parcel that is sent blindly after 5, 10, 15 or 20 s look like an answer.
exam = build(alone_s=_draw.choice((11.0, 11.8, 16.5)), between_s=_draw.choice((1.0, 2.0, 3.0)))
