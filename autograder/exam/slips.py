"""
Slips that fit many exercises, by family: a limit, a count, a memory that should not be there.

A family takes the part of a specification in which the mistake is made, and returns slips for
:class:`autograder.exam.specification.Specification`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
import math
import operator
from typing import Any

from autograder.exam.specification import Cause, Rule, Slip

HIGHEST = 125.0
"""Above it, some programs take a value for a fault; common sensors measure up to it."""
Compare = Callable[[float, float], bool]
"""Tells by a value and its limit whether a warning is due."""

REPEATED = Cause(
    'repeated_warning',
    'The same value is warned about more than once.',
    'One call of self.get_logger().warning(...) in the callback, one subscription, and no timer '
    'or thread for it.',
)
MISSED_WARNING = Cause(
    'missed_warning',
    'Other values are warned about, this one is not.',
    'Compare each value by itself, without int(), round(), once= and without memory.',
)
FALSE_ALARM = Cause(
    'false_alarm',
    'A value that is not above the limit is warned about.',
    'Compare the value of this message with the limit, without abs() and without memory.',
)
NO_WARNING = Cause(
    'no_warning',
    'No warning is ever logged.',
    'In the callback, if the value is above the limit: self.get_logger().warning(...).',
)
NO_ANSWER = Cause(
    'no_answer',
    'Nothing is published when a message arrives.',
    'Publish in the callback of the subscription, for each message.',
)
LEAVES_OUT = Cause(
    'leaves_out',
    'Some messages are answered, and this one is not.',
    'Publish for each message that asks for it, whatever is in it and whatever came before.',
)
UNASKED = Cause(
    'speaks_unasked',
    'A message is published although none has come.',
    'Publish in the callback of the subscription, and from nowhere else.',
)
SEVERAL_ANSWERS = Cause(
    'several_answers',
    'More is published for one message than it asks for.',
    'Publish once in the callback, and from nowhere else.',
)
MISSES_SOME = Cause(
    'misses_some',
    'Where several messages come at once, some of them are not answered.',
    'Is the depth of your subscription 10? If it is, publish in its callback, once per message.',
)


def _whole(cut: Callable[[float], float]) -> Compare:
    return lambda value, limit: math.isfinite(value) and cut(value) > limit


def above_limit(rule: Callable[[Compare], Rule], limit: str) -> tuple[Slip, ...]:
    """
    Return the slips of a comparison: a warning is due strictly above a limit.

    :param rule: makes the rule that has this comparison in it; its answers count warnings
    :param limit: as it stands in the learner's code, ``30.0`` or ``self.limit``
    """
    strictly = f'Above means strictly greater: value > {limit}, not >=.'
    each_itself = f'Compare each value as it came: value > {limit}'
    return (
        Slip(
            'warns_at_threshold',
            'The comparison includes the limit itself.',
            strictly,
            rule(operator.ge),
        ),
        Slip(
            'comparison_reversed',
            'It warns below the limit and not above it.',
            f'Above the limit is value > {limit}.',
            rule(operator.lt),
        ),
        Slip(
            'sign_ignored',
            'It warns of a value far below zero: its size is compared, not its value.',
            f'{each_itself}, without abs().',
            rule(lambda value, limit: abs(value) > limit),
        ),
        Slip(
            'upper_bound',
            'A value far above the limit is not warned about, as if it were a fault.',
            f'Warn of each value with value > {limit}, however high.',
            rule(lambda value, limit: limit < value <= HIGHEST),
        ),
        *(
            Slip(
                'cut_off',
                'A value just above the limit is not warned about: its decimals are cut off or '
                'rounded, or the limit is another number.',
                f'{each_itself}, without int(), // and round().',
                rule(_whole(cut)),
            )
            for cut in (math.trunc, round, lambda one: round(one, 1), lambda one: round(one, 2))
        ),
    )


def of_nan(rule: Callable[[Compare], Rule], limit: str) -> Slip:
    """Return the slip that takes NaN for a value above the limit, see :func:`above_limit`."""
    return Slip(
        'nan',
        'A WARN line comes for NaN, which is not above the limit: every comparison with it is '
        'false.',
        f'Ask value > {limit}, not not (value <= {limit}). In a branch for math.isnan(value), log '
        'no warning.',
        rule(lambda value, limit: not value <= limit),
    )


def with_memory(rule: Rule) -> tuple[Slip, ...]:
    """
    Return the slips of a program that goes by earlier inputs, where each counts by itself.

    :param rule: what is due; its answers count warnings
    """

    def changed(change: Callable[[Sequence[Any]], Sequence[Any]]) -> Rule:
        return lambda inputs: change(rule(inputs))

    def first_only(due: Sequence[int]) -> list[int]:
        return [one if not any(due[:place]) else 0 for place, one in enumerate(due)]

    def changes_only(due: Sequence[int]) -> list[int]:
        return [one if not before else 0 for before, one in zip([0, *due], due)]

    def goes_on(due: Sequence[int]) -> list[int]:
        return [int(any(due[: place + 1])) for place in range(len(due))]

    alone = 'Look at the value of this message alone'
    return (
        Slip(
            'warns_once',
            'The first value above the limit is warned about, and none after it.',
            f'{alone}: no flag, no once= and no throttle.',
            changed(first_only),
        ),
        Slip(
            'warns_of_changes',
            'A value above the limit is warned about only if the one before it was not above.',
            f'{alone}, without a flag for the last state.',
            changed(changes_only),
        ),
        Slip(
            'warns_ever_after',
            'Once a value was above the limit, every later one is warned about too.',
            f'{alone}, without a flag that stays set and without a maximum.',
            changed(goes_on),
        ),
        Slip.of(REPEATED, changed(lambda due: [2 * one for one in due])),
    )


def leaving_out(rule: Rule, key: Callable[[Any], Any] = lambda one: one) -> tuple[Slip, ...]:
    """
    Return the slips of a program that does not answer each message.

    :param rule: what is due; its answers are tuples with a value for each message
    :param key: what a program may look at to decide
    """

    def unless(skips: Callable[[Any, Sequence[Any]], bool]) -> Rule:
        def slipped(inputs: Sequence[Any]) -> list[Any]:
            keys = [key(one) for one in inputs]
            left = [skips(one, keys[:place]) for place, one in enumerate(keys)]
            return [() if out else due for out, due in zip(left, rule(inputs))]

        return slipped

    each_one = 'Publish for each message, without a look at'
    return (
        Slip.of(NO_ANSWER, unless(lambda one, before: True)),
        Slip(
            'skips_equal',
            'A message that is equal to the one before it is not answered.',
            f'{each_one} the last one.',
            unless(lambda one, before: one in before[-1:]),
        ),
        Slip(
            'skips_known',
            'A message that is equal to an earlier one is not answered.',
            f'{each_one} earlier ones.',
            unless(lambda one, before: one in before),
        ),
        Slip(
            'skips_empty',
            'An empty text or a zero is not answered, and it is a message like any other.',
            f'{each_one} what is in it.',
            unless(lambda one, before: not one),
        ),
    )
