"""Lesson 06, part 3, as it is graded: zero is refused too, and the numbers are secret."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.managed_pressure import build, Inputs

_draw = generator('managed_pressure', 'limits and pressures')
# Rounded to any digit or cut off, a pressure just above it is not above it.
_first = _draw.choice((3.11, 3.12, 3.13, 3.21, 3.22, 3.23, 3.31, 3.32, 3.33))
_second = round(_draw.uniform(0.1, 0.4), 2)
_edges = [
    _first,
    round(_first + 0.01, 2),
    round(_first + 0.004, 3),
    round(_first - 0.01, 2),
    round(-_first - _draw.uniform(1.0, 3.0), 2),  # of a size above the limit
    round(_draw.uniform(0.5, 1.9), 2),
    0.0,
]
_draw.shuffle(_edges)
_high = [round(_draw.uniform(4.5, 20.0), 2) for _ in range(2)]
# The same value again, and another one: each is above by itself.
_active = [*_edges, _high[0], _high[0], _high[1], round(_draw.uniform(0.5, 1.9), 2)]
exam = build(
    Inputs(
        refused=(-1.0, 0.0, round(_draw.uniform(-5.0, -0.2), 2)),
        limits=(_first, _second),
        pressures={
            'accepted': (9.5, 1.5),
            'active': tuple(_active),
            'paused': (9.75, 20.5),
            'still': (round(_draw.uniform(8.5, 12.0), 2), round(_draw.uniform(0.5, 1.9), 2)),
            'again': (
                round(_draw.uniform(0.5, 1.9), 2),
                _second,
                round(_draw.uniform(8.5, 12.0), 2),
            ),
        },
    )
)
