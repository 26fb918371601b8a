"""Lesson 07, part 2, as it is graded: a whole minute, at a moment nobody can know."""

from __future__ import annotations

from autograder.exams.visible.temperature_publisher import build
from autograder.runs.inputs import generator

exam = build(
    seconds=60,
    phase_s=round(generator('temperature_publisher', 'phase').uniform(0.02, 0.23), 3),
)
