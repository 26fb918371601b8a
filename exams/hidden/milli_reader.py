"""Hidden exam of lesson 04, part 2: secret numbers and names, and a burst."""

from autograder.exam.inputs import generator
from autograder.exam.steps import BURST
from exams.visible.milli_reader import build

_draw = generator('milli_reader', 'numbers')


def _number(rest: int) -> int:
    """
    Return a random number whose absolute value has a given remainder modulo 1000.

    Small remainders reveal fractions assembled from digits, large ones reveal rounding.
    """
    return int(_draw.choice((-1, 1)) * (1000 * _draw.randrange(1, 10**6) + rest))


def _name() -> str:
    return f'sensor_{_draw.randrange(10**6)}'


_same = _number(457), _name()
exam = build(
    # Repeated numbers, zero and numbers without a description are ordinary inputs.
    [
        abs(_number(7)),
        _same[0],
        _same[0],
        0,
        _draw.randrange(1, 10),
        -_draw.randrange(101, 999),  # the whole part, 0, has no sign
        -abs(_number(682)),
        *map(_number, (7, 138)),
        _same[0],
        *map(_number, (457, 138, 7)),
        *(_number(_draw.randrange(1, 1000)) for _ in range(BURST - 3)),
    ],
    [
        *(_name(), _same[1], _same[1]),
        *(f' Fahrenheit {_name()} ', _name(), _name(), _name()),
        *(_name(), '', _same[1]),
        *(_name() for _ in range(BURST)),
    ],
    burst=BURST,
)
