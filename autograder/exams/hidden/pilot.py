"""Hidden exam of lesson 02, part 5: secret values; the other topic has the first message."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.pilot import build, journey

_draw = generator('pilot', 'inputs')
_sizes = _draw.sample(range(50, 2000), 15)
_signs = [_draw.choice((-1, 1)) for _ in _sizes]
_signs[2:4] = (-_signs[0], -_signs[1])  # each topic has numbers above and below zero
_values = [round(sign * size / 1000, 3) for sign, size in zip(_signs, _sizes)]
exam = build(journey(_values, first=1))
