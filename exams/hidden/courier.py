"""Hidden exam of lesson 03, part 3: subscriptions join at secret times."""

from autograder.exam.inputs import generator
from exams.visible.courier import build

_draw = generator('courier', 'moments')
# The first subscription joins after about one minute, at a time when a parcel would be late if a
# node published it blindly at a multiple of 5 s, or checked every 3 s.
# No other one joins soon after it: a node that waits for two would then be on time.
# Ten more join at the end, because a node may have names or room for only a few.  A minute later,
# the node must still run.
exam = build(
    alone_s=_draw.choice((57.8, 57.85, 57.9)),
    between_s=_draw.choice((1.0, 2.0, 3.0)),
    others=10,
    after_s=60.0,
)
