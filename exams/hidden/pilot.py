"""Hidden exam of lesson 02, part 5: secret values; the first message is a speed."""

from autograder.exam.inputs import generator
from exams.visible.pilot import build, journey

_draw = generator('pilot', 'inputs')
_small, _large = _draw.sample(range(50, 1000), 13), _draw.sample(range(1050, 2000), 2)
_sizes = [*_small[:2], *_large, *_small[2:]]
_sizes[4], _sizes[7] = _draw.sample(range(1, 10), 2)  # a speed and a turn near zero
_signs = [_draw.choice((-1, 1)) for _ in _sizes]
_signs[2:4] = (-_signs[0], -_signs[1])  # each topic has numbers above and below zero
_values = [round(sign * size / 1000, 3) for sign, size in zip(_signs, _sizes)]
exam = build(journey(_values, first=0))
