"""Hidden exam of lesson 05, part 5: secret distances."""

import math

from autograder.exam.inputs import generator
from exams.visible.sensor_watch import build

_draw = generator('sensor_watch', 'distances')
_near = _draw.choice((0.12, 0.15))
# The third decimals show a node that cuts decimals off, or rounds them up, instead of rounding to
# 0.01.  A log line with only five significant digits does not show the last of these.
_whole = (*_draw.sample(range(1, 10), k=2), _draw.randint(1000, 9000))
_parts = [_draw.choice(one) for one in ((0.253, 0.753), (0.247, 0.747), (0.253, 0.753))]
_far = [round(whole + part, 3) for whole, part in zip(_whole, _parts)]
# A repeated distance, zero, a short and a negative distance are ordinary inputs.
_first = [_far[0], _far[1], _far[1], 0.0, _near, -_far[0], _far[1]]
exam = build(_first, [_far[1], _far[2], math.inf])
