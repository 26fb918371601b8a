"""
Define slips that fit many exercises: warnings, skipped messages, ranges, limited numbers.

Each function gets a rule, or a function that builds a rule around the mistaken part.  It returns
slips for :class:`autograder.exam.specification.Specification`.
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise, takewhile
import math
import operator
from typing import Any

from autograder.exam.specification import Rule, Slip
from autograder.exam.words import Causes

HIGHEST = 125.0
"""Highest value of common sensors; some programs treat a higher one as a sensor fault."""
Compare = Callable[[float, float], bool]
"""Returns whether a warning is due, given a value and its limit."""

WHY = Causes(__file__)
REPEATED = WHY['repeated_warning']
SKIPS_EQUAL = WHY['skips_equal']
NO_WARNING = WHY['no_warning']
CUTS: tuple[Callable[[float], float], ...] = (
    *(math.trunc, round),
    *(lambda value: round(value, 1), lambda value: round(value, 2)),
)
"""Ways to truncate or round the decimals of a value."""


def warning_slips(
    rule: Callable[[Compare], Rule], limit: str, burst: int = 0, more: Sequence[Slip] = ()
) -> tuple[Slip, ...]:
    """
    Return the slips of a program that warns about each value strictly above a limit.

    :param rule: builds the rule with the given comparison; its answers count warnings
    :param limit: as in the learner's code, ``30.0`` or ``self.limit``
    :param burst: number of inputs at the end that are sent at once
    :param more: slips of the exercise, which are less likely than a wrong comparison
    """
    due = rule(operator.gt)
    rising = WHY.slip('warns_of_maxima', lambda inputs: rule(_rising())(inputs))
    return (*_comparisons(rule, limit), *more, *_memories(due), rising, *_in_a_burst(due, burst))


def _rising() -> Compare:
    """Return the comparison of a program that warns only about values above all earlier ones."""
    highest = -math.inf

    def higher(value: float, limit: float) -> bool:
        nonlocal highest
        before, highest = highest, max(highest, value)
        return value > max(limit, before)

    return higher


def _comparisons(rule: Callable[[Compare], Rule], limit: str) -> tuple[Slip, ...]:
    def cutting(cut: Callable[[float], float]) -> Rule:
        return rule(lambda value, limit: (cut(value) if math.isfinite(value) else value) > limit)

    def slip(name: str, *rules: Rule) -> Slip:
        return WHY.slip(name, *rules, limit=limit)

    return (
        slip('warns_at_threshold', rule(operator.ge)),
        slip('comparison_reversed', rule(operator.lt)),
        slip('sign_ignored', rule(lambda value, limit: abs(value) > limit)),
        slip('upper_bound', rule(lambda value, limit: limit < value <= HIGHEST)),
        slip('cut_off', *map(cutting, CUTS)),
        slip('nan', rule(lambda value, limit: math.isnan(value) or value > limit)),
        slip('ignores_infinity', rule(lambda value, limit: limit < value < math.inf)),
    )


def _memories(rule: Rule) -> tuple[Slip, ...]:
    """Return the slips of a program that remembers inputs although each one is independent."""

    def changed(change: Callable[[Sequence[Any]], Sequence[Any]]) -> Rule:
        return lambda inputs: change(rule(inputs))

    def first_only(due: Sequence[int]) -> list[int]:
        return [one if not any(due[:place]) else 0 for place, one in enumerate(due)]

    def changes_only(due: Sequence[int]) -> list[int]:
        return [one if not before else 0 for before, one in zip([0, *due], due)]

    def goes_on(due: Sequence[int]) -> list[int]:
        return [int(any(due[: place + 1])) for place in range(len(due))]

    def unless_equal(inputs: Sequence[Any]) -> list[int]:
        again = [False, *(one == before for before, one in pairwise(inputs))]
        return [0 if equal else one for equal, one in zip(again, rule(inputs))]

    return (
        WHY.slip('warns_once', changed(first_only)),
        WHY.slip('warns_of_changes', changed(changes_only)),
        WHY.slip('warns_ever_after', changed(goes_on)),
        WHY.slip('skips_equal', unless_equal),
        WHY.slip('repeated_warning', changed(lambda due: [2 * one for one in due])),
    )


def _in_a_burst(rule: Rule, burst: int) -> tuple[Slip, ...]:
    """Return the slip of a program that does not log each of several warnings at once."""

    def without(count: int) -> Rule:
        def part(inputs: Sequence[Any]) -> list[int]:
            *single, last = [*rule(inputs)[:-burst], sum(rule(inputs)[-burst:])]
            return [*single, max(1, last - count), *[0] * (burst - 1)]

        return part

    return (WHY.slip('part_of_a_burst', *map(without, range(1, burst))),) if burst else ()


Change = Callable[[float], float]
"""Returns the number that a program publishes for one that it should leave unchanged."""


NEAR_ZERO = (0.01, 0.05, 0.1)
"""Sizes below which a program may treat a number as zero."""


def changing(*rules: Callable[[Change], Rule], digits: Sequence[int] = (1, 2)) -> tuple[Slip, ...]:
    """
    Return the slips of a program that changes a number that it should publish unchanged.

    :param rules: build the rule of a program that changes numbers with the given function; several
        if a program may change only some of the numbers
    :param digits: numbers of decimals to which a program may round
    """

    def slip(name: str, *changes: Change) -> Slip:
        return WHY.slip(name, *(rule(change) for change in changes for rule in rules))

    return (
        slip('sign_lost', abs),
        slip('negative_is_zero', lambda number: max(0.0, number)),
        slip(
            'whole_numbers',
            *(lambda number, cut=cut: float(cut(number)) for cut in (math.floor, *CUTS[:2])),
        ),
        slip('rounded', *(lambda number, to=to: round(number, to) for to in digits)),
        slip('near_zero_is_zero', *(partial(_without_near_zero, most) for most in NEAR_ZERO)),
    )


def _without_near_zero(most: float, number: float) -> float:
    return 0.0 if abs(number) < most else number


def leaving_out(
    rule: Rule,
    key: Callable[[Any], Any] = lambda one: one,
    do: str = 'Publish',
    numbers: bool = False,
) -> tuple[Slip, ...]:
    """
    Return the slips of a program that leaves some messages unanswered.

    :param rule: the correct rule; its answers are tuples with the expected messages for each input
    :param key: returns the part of an input by which a program may decide to skip it
    :param do: what to do for each message, as the first word of a sentence
    :param numbers: whether the keys are numbers; a program may leave out, say, negative numbers
    """

    def slip(name: str, skips: Callable[[Any, Sequence[Any]], bool]) -> Slip:
        def slipped(inputs: Sequence[Any]) -> list[Any]:
            keys = [key(one) for one in inputs]
            left = [skips(one, keys[:place]) for place, one in enumerate(keys)]
            return [() if out else due for out, due in zip(left, rule(inputs))]

        return WHY.slip(name, slipped, do=do)

    found = (
        slip('no_answer', lambda one, before: True),
        slip('leaves_out_equal', lambda one, before: one in before[-1:]),
        slip('skips_known', lambda one, before: one in before),
        slip('skips_empty', lambda one, before: not one),
    )
    if not numbers:
        return (*found, slip('stops_at_empty', lambda one, before: not all([one, *before])))
    return (
        *found,
        slip('skips_negative', lambda one, before: one < 0),
        slip('skips_not_positive', lambda one, before: one <= 0),
    )


# -- ranges and limited numbers ------------------------------------------------------------


Accepts = Callable[[float], bool]
"""Returns whether a value is accepted."""


def range_slips(
    rule: Callable[[Accepts], Rule], lowest: float, highest: float
) -> tuple[Slip, ...]:
    """Return the slips of a range check; both ends are valid, and the lower one is negative."""

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
        slip('refuses_negative', lambda value: max(0.0, lowest) <= value <= highest),
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
            'limited_sign_lost',
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
