"""Hidden exam of lesson 07, part 5: secret limits in a secret order."""

from autograder.exam.inputs import generator
from exams.visible.limit_keeper import (
    build,
    Change,
    HIGHEST_C,
    JUST_OUTSIDE,
    LIMIT,
    LOWEST_C,
    NO_NUMBERS,
    PLACE,
)

_draw = generator('limit_keeper', 'limits')


def _between(low: float, high: float) -> float:
    return round(_draw.uniform(low, high), 2)


_limits: list[float | int] = [
    *(*NO_NUMBERS, *JUST_OUTSIDE, 0.0, LOWEST_C, HIGHEST_C, LOWEST_C - _between(0.01, 0.4)),
    *(HIGHEST_C + _between(0.01, 0.4), _between(200.0, 900.0), _between(-900.0, -200.0)),
    *(_between(-39.0, -1.0), _between(32.0, 110.0), _draw.randint(31, 99)),
]
_changes: list[Change] = [(LIMIT, one) for one in _limits]
exam = build(
    _draw.choice((27.1, 27.2, 27.3, 28.1, 28.2, 28.3, 28.4)),
    [
        # Change the place right after an accepted limit.  Otherwise a node that stores refused
        # limits could refuse the place too, and one mistake would look like two.
        *((LIMIT, _between(40.0, 90.0)), (PLACE, 'roof'), (LIMIT, NO_NUMBERS[0])),
        *_draw.sample(_changes, len(_changes)),
        *((LIMIT, _between(40.0, 90.0)), (PLACE, '')),
    ],
)
