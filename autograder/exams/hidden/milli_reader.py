"""Lesson 04, part 2, as it is graded: numbers and names nobody can know, and a burst."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.milli_reader import build

_draw = generator('milli_reader', 'numbers')
exam = build(
    # A small fraction shows digits that were put together, a large one what was rounded.
    [
        _draw.choice((-1, 1)) * (1000 * _draw.randrange(1, 10**6) + rest)
        for rest in (7, 457, 7, 682, 7, 457, 138, 7)
    ],
    [f'sensor_{_draw.randrange(10**6)}' for _ in range(8)],
    burst=3,
)
