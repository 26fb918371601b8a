"""Hidden exam of lesson 03, part 3: subscriptions join at secret times."""

from __future__ import annotations

from autograder.exam.inputs import generator
from autograder.exams.visible.courier import build

_draw = generator('courier', 'moments')
# After a minute in which nobody came; none lets a parcel that is sent blindly after so many times
# five seconds, or by a node that looks every three seconds, come in time.
exam = build(alone_s=_draw.choice((59.2, 59.25, 59.3)), between_s=_draw.choice((1.0, 2.0, 3.0)))
