"""Hidden exam of lesson 03, part 2: a longer run in a secret namespace."""

from autograder.exam.inputs import generator, WATCH_S
from exams.visible.talker import build

_draw = generator('talker', 'place')
exam = build(
    f'/{"".join(_draw.choices("bdghjklmnprtvwz", k=6))}',
    seconds=float(WATCH_S),
    comes=True,
)
