"""
Define slips that fit many exercises: limits, warning counts, unwanted state, skipped messages.

Each function gets the specification, or a function that builds it around the mistaken part.  It
returns slips for :class:`autograder.exam.specification.Specification`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
import math
import operator
from typing import Any

from autograder.exam.specification import Cause, Rule, Slip

HIGHEST = 125.0
"""Some programs treat a higher value as a sensor fault; common sensors measure up to it."""
Compare = Callable[[float, float], bool]
"""Returns whether a warning is due, given a value and its limit."""

REPEATED = Cause(
    'repeated_warning',
    'Your node warns more than once about the same value.',
    'One call of self.get_logger().warning(...) in the callback, one subscription, and no timer '
    'or thread for it.',
)
SKIPS_EQUAL = Cause(
    'skips_equal',
    'Your node skips a message that equals the previous one.',
    'Handle each message, and do not compare it with the last one.',
)
MISSED_WARNING = Cause(
    'missed_warning',
    'Your node warns about other values above the limit, but not about this one.',
    'Compare each value separately: no int(), no round(), no once=, and no stored state.',
)
FALSE_ALARM = Cause(
    'false_alarm',
    'Your node warns about a value that is not above the limit.',
    'Compare only the value of this message with the limit: no abs() and no stored state.',
)
NO_WARNING = Cause(
    'no_warning',
    'Your node never logs a warning.',
    'In the callback, if the value is above the limit: self.get_logger().warning(...).',
)
NO_ANSWER = Cause(
    'no_answer',
    'Your node publishes nothing when a message arrives.',
    'Publish in the callback of the subscription, for each message.',
)
LEAVES_OUT = Cause(
    'leaves_out',
    'Your node answers some messages, but not this one.',
    'Publish for each message that needs an answer, whatever it contains and whatever arrived '
    'before it.',
)
UNASKED = Cause(
    'speaks_unasked',
    'Your node publishes a message although it has received none.',
    'Publish only in the callback of the subscription.',
)
RUNS_EARLY = Cause(
    'runs_early',
    'Your node publishes a message before it has received one: its timer runs from the start.',
    'Publish in the callback of the subscription. If the exercise needs the timer, create it with '
    'autostart=False and call its reset() in that callback.',
    act='publishing_timer',
)
SEVERAL_ANSWERS = Cause(
    'several_answers',
    'Your node publishes too many messages for one input.',
    'Publish once in the callback, and nowhere else.',
)
MISSES_SOME = Cause(
    'misses_some',
    'If several messages arrive at once, your node does not answer each of them.',
    'Is the depth of your subscription 10? If it is, publish in its callback, once per message.',
)


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
    return (*_comparisons(rule, limit), *more, *_memories(due), *_in_a_burst(due, burst))


def _comparisons(rule: Callable[[Compare], Rule], limit: str) -> tuple[Slip, ...]:
    each_itself = f'Compare each received value unchanged: value > {limit}'

    def cutting(cut: Callable[[float], float]) -> Rule:
        return rule(lambda value, limit: math.isfinite(value) and cut(value) > limit)

    return (
        Slip(
            'warns_at_threshold',
            'The comparison includes the limit itself.',
            f'Above means strictly greater: value > {limit}, not >=.',
            rule(operator.ge),
        ),
        Slip(
            'comparison_reversed',
            'Your node warns below the limit, but not above it.',
            f'Above the limit is value > {limit}.',
            rule(operator.lt),
        ),
        Slip(
            'sign_ignored',
            'Your node warns about a value far below zero: it compares the absolute value.',
            f'{each_itself}, without abs().',
            rule(lambda value, limit: abs(value) > limit),
        ),
        Slip(
            'upper_bound',
            'Your node does not warn about a value far above the limit, as if it were an invalid '
            'reading.',
            f'Warn of each value with value > {limit}, however high.',
            rule(lambda value, limit: limit < value <= HIGHEST),
        ),
        Slip(
            'cut_off',
            'Your node does not warn about a value just above the limit: it rounds the value or '
            'cuts its decimals off, or it uses a different limit.',
            f'{each_itself}, without int(), // and round().',
            *map(cutting, CUTS),
        ),
        Slip(
            'nan',
            'Your node logs a WARN line for NaN, which is not above the limit: every comparison '
            'with NaN is false.',
            f'Ask value > {limit}, not not (value <= {limit}). In a branch for math.isnan(value), '
            'log no warning.',
            rule(lambda value, limit: math.isnan(value) or value > limit),
        ),
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

    alone = 'Use only the value of this message'
    return (
        Slip(
            'warns_once',
            'Your node warns about the first value above the limit, but about no later one.',
            f'{alone}: no flag, no once= and no throttle.',
            changed(first_only),
        ),
        Slip(
            'warns_of_changes',
            'Your node warns only if the previous value was not above the limit.',
            f'{alone}, without a flag for the last state.',
            changed(changes_only),
        ),
        Slip(
            'warns_ever_after',
            'After one value above the limit, your node warns about every later value too.',
            f'{alone}, without a flag that stays set and without a maximum.',
            changed(goes_on),
        ),
        Slip.of(SKIPS_EQUAL, unless_equal),
        Slip.of(REPEATED, changed(lambda due: [2 * one for one in due])),
    )


def _in_a_burst(rule: Rule, burst: int) -> tuple[Slip, ...]:
    """Return the slip of a program that does not log each of several warnings at once."""

    def one_of_them(inputs: Sequence[Any]) -> list[int]:
        return [*rule(inputs)[:-burst], 1, *[0] * (burst - 1)]

    return (
        Slip(
            'one_of_a_burst',
            'If several values above the limit arrive at once, your node warns about only one.',
            'Give create_subscription() the depth 10, and log a line for each value: no '
            'throttle_duration_sec= and no timer.',
            one_of_them,
        ),
    )[: bool(burst)]


Change = Callable[[float], float]
"""Returns what a program makes of a number that it should leave unchanged."""


def changing(*rules: Callable[[Change], Rule], digits: Sequence[int] = (1, 2)) -> tuple[Slip, ...]:
    """
    Return the slips of a program that changes a number that it should publish as it is.

    :param rules: build the rule of a program that changes numbers with the given function; several
        if a program may change only some of the numbers
    :param digits: numbers of decimals to which a program may round
    """

    def slip(cause_id: str, text: str, try_this: str, *changes: Change) -> Slip:
        return Slip(
            cause_id, text, try_this, *(rule(change) for change in changes for rule in rules)
        )

    return (
        slip(
            'sign_lost',
            'Numbers below zero lose their sign.',
            'Leave out abs(), and publish negative numbers too.',
            abs,
        ),
        slip(
            'negative_is_zero',
            'A number below zero becomes 0.0.',
            'Leave out max(0.0, ...): negative numbers are ordinary numbers.',
            lambda number: max(0.0, number),
        ),
        slip(
            'whole_numbers',
            'The decimals are lost: //, int() and round() give whole numbers.',
            'Divide with /, and publish the result without int() and round().',
            *(lambda number, cut=cut: float(cut(number)) for cut in (math.floor, *CUTS[:2])),
        ),
        slip(
            'rounded',
            'The number is rounded.',
            'Publish it as it is, without round() and without a format such as :.2f.',
            *(lambda number, to=to: round(number, to) for to in digits),
        ),
    )


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
    :param numbers: whether the keys are numbers, of which a program may leave out some kinds
    """

    def unless(skips: Callable[[Any, Sequence[Any]], bool]) -> Rule:
        def slipped(inputs: Sequence[Any]) -> list[Any]:
            keys = [key(one) for one in inputs]
            left = [skips(one, keys[:place]) for place, one in enumerate(keys)]
            return [() if out else due for out, due in zip(left, rule(inputs))]

        return slipped

    each_one = f'{do} for each message, and do not check'
    kinds: tuple[tuple[str, str, str, Callable[[Any, Sequence[Any]], bool]], ...] = (
        ('equal', 'a message that equals the previous one', 'the last one',
         lambda one, before: one in before[-1:]),
        ('known', 'a message that equals an earlier one', 'earlier ones',
         lambda one, before: one in before),
        ('empty', 'an empty string or a zero, but they are ordinary messages', 'what is in it',
         lambda one, before: not one),
        ('negative', 'a number below zero', 'what is in it', lambda one, before: one < 0),
        ('not_positive', 'zero and numbers below zero', 'what is in it',
         lambda one, before: one <= 0),
    )  # fmt: skip
    return (
        Slip.of(NO_ANSWER, unless(lambda one, before: True)),
        *(
            Slip(
                f'skips_{kind}', f'Your node does not answer {which}.', f'{each_one} {what}.', out
            )
            for kind, which, what, out in (
                (*words, unless(skips)) for *words, skips in kinds[: 5 if numbers else 3]
            )
        ),
    )
