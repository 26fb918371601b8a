"""Hidden exam of lesson 02, part 5: secret values; either topic may have the first message."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.pilot import build, journey

_draw = generator('pilot', 'inputs')
_sizes = _draw.sample(range(50, 2000), 15)
_values = [round(_draw.choice((-1, 1)) * size / 1000, 3) for size in _sizes]
exam = build(journey(_values, first=_draw.choice((0, 1))))
