"""Lesson 04, part 2, as it is graded: numbers and names nobody can know."""

from __future__ import annotations

from autograder.exams.visible.milli_reader import build
from autograder.runs.inputs import generator

_draw = generator('milli_reader', 'numbers')
exam = build(
    [_draw.choice((-1, 1)) * (1000 * _draw.randrange(1, 10**6) + 7) for _ in range(5)],
    [f'sensor_{_draw.randrange(10**6)}' for _ in range(5)],
)
