"""Hidden exam of lesson 05, part 6: secret speeds and turns."""

from autograder.exam.inputs import generator
from autograder.exam.steps import BURST
from exams.visible.safety_stop import build, drive

_draw = generator('safety_stop', 'commands')
_slow = [size / 1000 for size in _draw.sample(range(50, 500), 6 + BURST)]
_small = [size / 1000 for size in _draw.sample(range(50, 500), 10 + BURST)]
# Far too fast for a robot; but no command may be dropped, and no turn limited.
_most = *_draw.sample(range(20_000, 50_000), 2), *_draw.sample(range(550, 1000), 2)
_large = [size / 1000 for size in _most]
_fast = [_draw.randrange(550, 1000) / 1000, *_draw.sample((-12_500.0, 15_000.0), 2)]
_near_zero = [size / 1000 for size in _draw.sample(range(1, 10), 2)]
# The limit itself is a speed like any other, and a robot may turn without a speed.
_first = [_slow[0], -_slow[1], _fast[0], _fast[1], _slow[2], 0.0, _near_zero[0], _fast[2], 0.5]
_turns = [*_small[:2], _large[0], -_large[1], _near_zero[1], _large[2], _small[6], -_large[3]]
exam = build(drive([*_first, *_slow[5:]], [*_turns, *_small[8:]]))
