"""Hidden exam of lesson 06, part 3: secret limits and pressures; it also tests a limit of zero."""

import math

from autograder.exam.inputs import generator
from autograder.exam.steps import BURST
from exams.visible.managed_pressure import build

_draw = generator('managed_pressure', 'limits and pressures')
# Rounding or truncating a pressure just above one of these limits gives at most the limit; a
# pressure 0.01 below the limit is above the rounded limit.
_first = _draw.choice((3.12, 3.13, 3.22, 3.23, 3.32, 3.33))
_second = round(_draw.uniform(0.1, 0.4), 2)


def _between() -> float:
    """Return a pressure between the two limits, even without its decimals."""
    return round(_draw.uniform(1.05, 1.9), 2)


def _high() -> float:
    return round(_draw.uniform(8.5, 20.0), 2)


_edges = [
    _first,
    round(_first + 0.01, 2),
    round(_first + 0.004, 3),
    round(_first - 0.01, 2),
    round(-_first - _draw.uniform(1.0, 3.0), 2),  # only its absolute value is above the limit
    round(_draw.uniform(500.0, 900.0), 1),  # above the limit, but not a sensor fault
    _between(),
    *(0.0, math.nan),
]
_draw.shuffle(_edges)
_again = _high()
# A log line with only three significant digits, or without decimals, does not show this limit.
_refused = -_draw.randint(100, 400) - _draw.choice((0.35, 0.45, 0.55, 0.65))
exam = build(
    refused=(-1.0, 0.0, _refused),
    limits=(_first, _second),
    highest=round(_draw.uniform(40.0, 90.0), 2),
    pressures={
        'accepted': (9.5, 1.5),
        # A repeated pressure and a different one: each needs its own warning.
        # Infinity follows: after it, a node that warns only about each new maximum never warns.
        'active': (*_edges, math.inf, _again, _again, _high(), _between()),
        'paused': (9.75, 20.5),
        'still': (_high(), _between(), round(_draw.uniform(0.02, 0.09), 3)),
        'again': (_between(), *(_high() for _ in range(1 + BURST))),
    },
)
