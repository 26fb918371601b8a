"""Hidden exam of lesson 03, part 2: a longer run in a secret namespace."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.talker import build

_draw = generator('talker', 'place')
exam = build(
    f'/{"".join(_draw.choices("bdghjklmnprtvwz", k=6))}',
    seconds=_draw.choice((61.0, 62.0, 63.0)),  # more than a hundred greetings
    comes=True,
)
