"""Hidden exam of lesson 06, part 2: longer active phases in a secret namespace."""

from autograder.exam.inputs import generator, WATCH_S
from exams.visible.managed_beacon import build

_draw = generator('managed_beacon', 'place and time')
exam = build(
    namespace='/' + ''.join(_draw.choices('bdghjklmnprstvz', k=6)),
    seconds=float(WATCH_S),
)
