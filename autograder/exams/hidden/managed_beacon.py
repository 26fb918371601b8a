"""Hidden exam of lesson 06, part 2: a secret namespace and secret durations."""

from autograder.exam.inputs import generator, WATCH_S
from autograder.exams.visible.managed_beacon import build

_draw = generator('managed_beacon', 'place and time')
exam = build(
    namespace='/' + ''.join(_draw.choices('bdghjklmnprstvz', k=6)),
    seconds=float(WATCH_S + _draw.randint(0, 2)),
)
