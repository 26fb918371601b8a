"""Lesson 06, part 3, as it is graded: zero is refused too, and the numbers are secret."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.managed_pressure import build, Inputs

_draw = generator('managed_pressure', 'limits and pressures')
# Rounded to any digit or cut off, a pressure just above it is not above it.
_first = _draw.choice((0.11, 0.12, 0.13, 0.21, 0.22, 0.23, 0.31, 0.32, 0.33))
_second = round(_draw.uniform(40.0, 60.0), 2)


def _low() -> float:
    return round(_draw.uniform(0.01, 0.09), 2)


def _middle() -> float:
    """Return a pressure between both limits."""
    return round(_draw.uniform(8.5, 20.0), 2)


_edges = [
    _first,
    round(_first + 0.01, 2),
    round(_first + 0.004, 3),
    round(_first - 0.01, 2),
    round(-_first - _draw.uniform(1.0, 3.0), 2),  # of a size above the limit
    round(_draw.uniform(500.0, 900.0), 1),  # no sensor's fault, but above the limit
    _low(),
    0.0,
]
_draw.shuffle(_edges)
_high = [_middle(), _middle()]
# The same value again, and another one: each is above by itself.
_active = [*_edges, _high[0], _high[0], _high[1], _low()]
# Rounded, it is another number.
_refused = round(-_draw.randint(0, 4) - _draw.choice((0.35, 0.45, 0.55, 0.65)), 2)
exam = build(
    Inputs(
        refused=(-1.0, 0.0, _refused),
        limits=(_first, _second),
        pressures={
            'accepted': (9.5, 1.5),
            'active': tuple(_active),
            'paused': (9.75, 20.5),
            'still': (_middle(), _low()),
            'again': (_middle(), _second, round(_draw.uniform(61.0, 99.0), 2), _low()),
        },
    )
)
