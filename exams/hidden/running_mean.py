"""Hidden exam of lesson 03, part 4: secret numbers, a pause, NaN twice, a huge one, a burst."""

import math

from autograder.exam.inputs import generator
from autograder.exam.steps import BURST
from exams.visible.running_mean import build

_draw = generator('running_mean', 'numbers')


def _numbers(count: int) -> list[float]:
    return [round(_draw.uniform(-900.0, 900.0), 3) for _ in range(count)]


# The first number is sent twice, so the mean stays the same; then the mean is exactly zero, then
# near zero, and then above zero.
_low = -round(_draw.uniform(1.0, 290.0), 3)
_first = [_low, _low, -2 * _low, 0.016, round(_draw.uniform(600.0, 900.0), 3)]
MANY = 104
exam = build(
    [
        *(*_first, *_numbers(MANY), math.nan, *_numbers(2), 0.0),
        # The huge one is late, because the means after it show small mistakes less precisely.
        *(_low, math.nan, *_numbers(3), round(_draw.uniform(3e9, 9e9), 3), *_numbers(BURST)),
    ],
    burst=BURST,
    pause=len(_first),
)
