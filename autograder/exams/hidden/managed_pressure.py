"""Hidden exam of lesson 06, part 3: secret limits and pressures; it also tests a limit of zero."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.managed_pressure import build

_draw = generator('managed_pressure', 'limits and pressures')
# Rounded to any digit or cut off, a pressure just above it is not above it.
_first = _draw.choice((3.11, 3.12, 3.13, 3.21, 3.22, 3.23, 3.31, 3.32, 3.33))
_second = round(_draw.uniform(0.1, 0.4), 2)


def _between() -> float:
    """Return a pressure between both limits."""
    return round(_draw.uniform(0.5, 1.9), 2)


def _high() -> float:
    return round(_draw.uniform(8.5, 20.0), 2)


_edges = [
    _first,
    round(_first + 0.01, 2),
    round(_first + 0.004, 3),
    round(_first - 0.01, 2),
    round(-_first - _draw.uniform(1.0, 3.0), 2),  # only its absolute value is above the limit
    round(_draw.uniform(500.0, 900.0), 1),  # no sensor's fault, but above the limit
    _between(),
    0.0,
]
_draw.shuffle(_edges)
_again = _high()
# Rounding would change this pressure.
_refused = round(-_draw.randint(0, 4) - _draw.choice((0.35, 0.45, 0.55, 0.65)), 2)
exam = build(
    refused=(-1.0, 0.0, _refused),
    limits=(_first, _second),
    highest=round(_draw.uniform(40.0, 90.0), 2),
    pressures={
        'accepted': (9.5, 1.5),
        # The same value again, and another one: each is above by itself.
        'active': (*_edges, _again, _again, _high(), _between()),
        'paused': (9.75, 20.5),
        'still': (_high(), _between()),
        'again': (_between(), _second, _high()),
    },
)
