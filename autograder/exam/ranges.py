"""
Define slips of a node that accepts only values in a range and uses the last accepted one.

As in :mod:`autograder.exam.slips`, each function gets a function that builds a rule around the
mistaken part.
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import takewhile
import math
from typing import Any

from autograder.exam.specification import Rule, Slip
from autograder.exam.words import Causes

WHY = Causes(__file__)

Accepts = Callable[[float], bool]
"""Returns whether a value is accepted."""


def range_slips(
    rule: Callable[[Accepts], Rule], lowest: float, highest: float
) -> tuple[Slip, ...]:
    """
    Return the slips of a range check; both ends of the range are valid.

    :param rule: builds the rule of a program with the given range check
    """

    def slip(name: str, *forms: Accepts) -> Slip:
        return WHY.slip(name, *map(rule, forms), lowest=lowest, highest=highest)

    return (
        slip('accepts_all', lambda value: True),
        slip('takes_nan', lambda value: not (value < lowest or value > highest)),
        slip('no_range', math.isfinite),
        slip(
            'no_lower_end',
            lambda value: value <= highest,
            lambda value: -math.inf < value <= highest,
            lambda value: abs(value) <= highest,
        ),
        slip(
            'no_upper_end',
            lambda value: value >= lowest,
            lambda value: lowest <= value < math.inf,
        ),
        slip(
            'nearly_in_range',
            lambda value: (
                lowest <= value <= highest
                or any(math.isclose(value, end, rel_tol=1e-6) for end in (lowest, highest))
            ),
        ),
        slip(
            'decimals_cut',
            *(
                lambda value, cut=cut: math.isfinite(value) and lowest <= cut(value) <= highest
                for cut in (math.trunc, round)
            ),
        ),
        slip(
            'ends_refused',
            lambda value: lowest < value < highest,
            lambda value: lowest < value <= highest,
            lambda value: lowest <= value < highest,
        ),
        slip('refuses_all', lambda value: False),
    )


Limit = Callable[[float, float], float | None]
"""Returns the number that a program publishes, given a number and its limit; None for nothing."""


def within(value: float, most: float) -> float:
    """Return the nearest number that is not further from 0 than the limit."""
    return max(-most, min(value, most))


def limiting_slips(rule: Callable[[Limit], Rule], value: str, most: str) -> tuple[Slip, ...]:
    """
    Return the slips of a program that limits a number on both sides of 0.

    :param rule: builds the rule of a program that limits numbers with the given function
    :param value: the number in the learner's code
    :param most: the limit in the learner's code
    """

    def slip(name: str, *forms: Limit) -> Slip:
        return WHY.slip(name, *map(rule, forms), value=value, most=most)

    def fast(change: Limit) -> Limit:
        return lambda value, most: change(value, most) if abs(value) > most else value

    return (
        slip('not_limited', lambda value, most: value),
        slip('one_side', min),
        slip(
            'sign_lost',
            lambda value, most: min(abs(value), most),
            fast(lambda value, most: most),
        ),
        slip('becomes_zero', fast(lambda value, most: 0.0)),
        slip('drops_fast', fast(lambda value, most: None)),
        slip('always_most', lambda value, most: most),
    )


def _constant(value: float, _: Any) -> float:
    return value


def in_force_slips(
    rule: Callable[[Callable[[Any], float]], Rule], parameter: str, default: float
) -> tuple[Slip, ...]:
    """
    Return the slips of a program that uses a wrong value of a parameter.

    :param rule: builds the rule of a program that reads its value with the given function; its
        inputs have ``start``, the value at the start, ``limit``, the current value, and ``tried``,
        the last requested value, accepted or not
    :param default: the default value in the code
    """

    def using(limits: Callable[[Sequence[Any]], Sequence[float]]) -> Rule:
        return lambda inputs: [
            rule(partial(_constant, limit))([one])[0] for limit, one in zip(limits(inputs), inputs)
        ]

    def before(inputs: Sequence[Any]) -> list[float]:
        return [one.limit for one in (*inputs[:1], *inputs)]

    def not_from_the_start(inputs: Sequence[Any]) -> list[float]:
        unchanged = sum(1 for _ in takewhile(lambda one: one.limit == one.start, inputs))
        return [default] * unchanged + [one.limit for one in inputs[unchanged:]]

    words: dict[str, Any] = {'parameter': parameter, 'default': default}
    return (
        WHY.slip('read_once', rule(lambda one: float(one.start)), **words),
        WHY.slip('number_in_the_code', rule(lambda one: default), **words),
        WHY.slip('keeps_refused', rule(lambda one: float(one.tried)), **words),
        WHY.slip('start_ignored', using(not_from_the_start), **words),
        WHY.slip('used_late', using(before), sometimes=True, **words),
    )
