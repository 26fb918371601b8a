"""Hidden exam of lesson 05, part 4: secret surveys, the last ones sent in a burst."""

import random

from autograder.exam.inputs import generator
from exams.visible.map_server import build

_ROOMS = ('hall', 'cellar', 'attic', 'yard', 'workshop', 'stairs', 'lab', 'office')


def surveys(draw: random.Random) -> list[str]:
    """
    Return the texts of the surveys.

    One text has leading and trailing spaces and a capital letter, one is sent twice in a row, the
    first one is sent again later, one is long, and one is empty.
    """
    texts = [f'{room} {draw.randrange(100, 1000)}' for room in draw.sample(_ROOMS, k=5)]
    spaced, twice = draw.sample(range(4), k=2)
    texts[spaced] = f'  {texts[spaced].capitalize()} '
    texts.insert(twice, texts[twice])
    long = ', '.join(draw.choices(_ROOMS, k=350))
    return [*texts[:-1], texts[0], long, '', texts[-1]]


_draw = generator('map_server', 'rooms')
_last = [f'{room} {_draw.randrange(1000, 10_000)}' for room in _draw.sample(_ROOMS, k=3)]
exam = build([*surveys(_draw), *_last], burst=len(_last))
