"""Hidden exam of lesson 02, part 5: more pictures, with secret names."""

from autograder.exam.inputs import generator
from exams.visible.inspector import build

_draw = generator('inspector', 'pictures')
_drawn = [''.join(_draw.choices('bcdfghjklmnprstvwz', k=6)) for _ in range(11)]
# A repeated picture, an earlier one, and names that are empty or have spaces around them are
# ordinary inputs.  The burst needs a queue of more than five.
# Two of its pictures are equal, and leaving out one of them does not look like a full queue.
_singles = [*_drawn[:3], _drawn[2], '', _drawn[0], f' {_drawn[3]} ', *_drawn[4:6]]
exam = build([*_singles, *_drawn[6:10], _drawn[8], _drawn[10]], burst=6)
