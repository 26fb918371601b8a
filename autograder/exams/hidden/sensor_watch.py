"""Lesson 05, part 5, as it is graded: with distances nobody can know."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.sensor_watch import build

_draw = generator('sensor_watch', 'distances')
exam = build([whole + _draw.choice((0.25, 0.75)) for whole in _draw.sample(range(1, 20), k=5)])
