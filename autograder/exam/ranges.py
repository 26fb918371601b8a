"""
Define slips of a node that accepts only values in a range and uses the last accepted one.

As in :mod:`autograder.exam.slips`, each function gets a function that builds a rule around the
mistaken part.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
import math
from typing import Any

from autograder.exam.specification import Rule, Slip

Accepts = Callable[[float], bool]
"""Returns whether a value is accepted."""


def range_slips(
    rule: Callable[[Accepts], Rule], lowest: float, highest: float
) -> tuple[Slip, ...]:
    """
    Return the slips of a range check; both ends of the range are valid.

    :param rule: builds the rule of a program with the given range check
    """
    test = f'Accept a value only if math.isfinite(value) and {lowest} <= value <= {highest}.'

    def slip(cause_id: str, text: str, *forms: Accepts, try_this: str = test) -> Slip:
        return Slip(cause_id, text, try_this, *map(rule, forms))

    return (
        slip(
            'accepts_all',
            'Each float is accepted, whatever its value.',
            lambda value: True,
            try_this=f'In __init__(): self.add_on_set_parameters_callback(self.validate). {test}',
        ),
        slip(
            'takes_nan',
            'NaN is accepted: it is neither below nor above a number.',
            lambda value: not (value < lowest or value > highest),
        ),
        slip('no_range', 'Each finite value is accepted.', math.isfinite),
        slip(
            'no_lower_end',
            f'A value below {lowest} is accepted.',
            lambda value: value <= highest,
            lambda value: -math.inf < value <= highest,
        ),
        slip(
            'no_upper_end',
            f'A value above {highest} is accepted.',
            lambda value: value >= lowest,
            lambda value: lowest <= value < math.inf,
        ),
        slip(
            'nearly_in_range',
            f'A value less than a millionth outside {lowest} to {highest} is accepted, as a '
            'FloatingPointRange does.',
            lambda value: (
                lowest <= value <= highest
                or any(math.isclose(value, end, rel_tol=1e-6) for end in (lowest, highest))
            ),
            try_this=f'Use a callback instead of a FloatingPointRange. {test}',
        ),
        slip(
            'decimals_cut',
            f'A value just outside {lowest} to {highest} is accepted: its decimals are cut off.',
            *(
                lambda value, cut=cut: math.isfinite(value) and lowest <= cut(value) <= highest
                for cut in (math.trunc, round)
            ),
            try_this='Compare the value unchanged, without int() and round().',
        ),
        slip(
            'ends_refused',
            f'{lowest} or {highest} itself is refused, and both are allowed.',
            lambda value: lowest < value < highest,
            lambda value: lowest < value <= highest,
            lambda value: lowest <= value < highest,
            try_this='Compare with <=, not with <.',
        ),
        slip(
            'refuses_all',
            'Each value is refused, including those that are allowed.',
            lambda value: False,
            try_this='Declare the parameter, and return SetParametersResult(successful=True) for '
            'a value that is allowed.',
        ),
    )


Limit = Callable[[float, float], float | None]
"""Returns what a program makes of a number and its limit; None if it publishes nothing."""


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
    clamp = f'Publish max(-{most}, min({value}, {most})): the limit has two sides.'

    def fast(change: Limit) -> Rule:
        return rule(lambda value, most: change(value, most) if abs(value) > most else value)

    return (
        Slip(
            'not_limited',
            'Numbers above the limit are passed on as they came.',
            clamp,
            rule(lambda value, most: value),
        ),
        Slip('one_side', 'Backwards, the number is not limited.', clamp, rule(min)),
        Slip(
            'sign_lost',
            'What should go backwards goes forwards.',
            f'{clamp} Leave out abs().',
            rule(lambda value, most: min(abs(value), most)),
            fast(lambda value, most: most),
        ),
        Slip(
            'becomes_zero',
            'A number above the limit becomes 0.0.',
            clamp,
            fast(lambda value, most: 0.0),
        ),
        Slip(
            'drops_fast',
            'A number above the limit has no answer.',
            clamp,
            fast(lambda value, most: None),
        ),
        Slip(
            'always_most',
            'The limit itself is always published.',
            clamp,
            rule(lambda value, most: most),
        ),
    )


def _constant(value: float, _: Any) -> float:
    return value


def in_force_slips(
    rule: Callable[[Callable[[Any], float]], Rule], parameter: str, default: float
) -> tuple[Slip, ...]:
    """
    Return the slips of a program that uses a wrong value of a parameter.

    :param rule: builds the rule of a program that reads its value with the given function; its
        inputs have ``start``, the value at the start, ``limit``, the one in force, and ``tried``,
        the last requested one, whether it was accepted or not
    :param default: the default value in the code
    """
    read_it = f"Read it where you need it: self.get_parameter('{parameter}').value."

    def late(inputs: Sequence[Any]) -> list[Any]:
        limits = [one.limit for one in (*inputs[:1], *inputs)]
        return [rule(partial(_constant, limit))([one])[0] for limit, one in zip(limits, inputs)]

    return (
        Slip(
            'read_once',
            f'The value that {parameter} had at the start is used after a change, too.',
            read_it,
            rule(lambda one: float(one.start)),
        ),
        Slip(
            'number_in_the_code',
            f'The value is always {default}, whatever {parameter} says.',
            read_it,
            rule(lambda one: default),
        ),
        Slip(
            'keeps_refused',
            f'A value of {parameter} that was refused is used.',
            f'Change nothing in the callback that validates. {read_it}',
            rule(lambda one: float(one.tried)),
        ),
        Slip(
            'used_late',
            f'After a change of {parameter}, your node uses the old value for a moment: it copies '
            'the value from time to time.',
            f'{read_it} Make no copy in a timer.',
            late,
        ),
    )
