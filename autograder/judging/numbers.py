"""Read numbers in log lines and messages, and explain wrong numbering."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
import math
import re
from typing import Any

from autograder.exam.exam import Cause
from autograder.exam.slips import Change
from autograder.exam.specification import each, Rule, Slip, Specification

COUNT_IN = 'Make self.count once, in __init__(), as 0, and add 1 in the callback, once.'
_NUMBER = re.compile(
    r'[-+]?(?:\d+(?:[.,]\d+)?(?:e[-+]?\d+)?|\b(?:nan|inf(?:inity)?)\b)', re.IGNORECASE
)
GRAIN = 0.051
"""Maximum difference between a value and its number in a text, which may have one decimal."""


def numbers_in(text: str) -> list[float]:
    """
    Return the numbers in a text, with their signs, including NaN and infinity.

    A comma may be the decimal separator.
    """
    return [float(found.replace(',', '.')) for found in _NUMBER.findall(text)]


def whole_numbers_in(text: str) -> list[int]:
    """Return the groups of digits in a text as integers: 003 is 3; digits of all scripts count."""
    return [int(digits) for digits in re.findall(r'\d{1,9}', text)]


ROUNDED_IN_TEXT = Cause(
    'rounded_in_text',
    'Your line shows the number rounded to too few digits.',
    'Log the number as it is, without int(), round() and a format such as :.0f or :.3g.',
)
ROUNDED: tuple[Change, ...] = (
    lambda number: number - math.fmod(number, 1.0),  # int()
    *(lambda number, to=to: float(format(number, to)) for to in ('.0f', '.1g', '.2g', '.3g')),
)
"""Ways to round a number too much for a log line."""


def near(some: Iterable[float], others: Sequence[float]) -> bool:
    """Return whether one of some numbers equals another one, with any rounding."""
    return any(
        abs(one - other) <= GRAIN or one == other or (math.isnan(one) and math.isnan(other))
        for one in some
        for other in others
    )


def shows(text: str, *values: float) -> bool:
    """Return whether a text shows one of some values, with any rounding."""
    return near(values, numbers_in(text))


def rounded(rule: Callable[[Change], Rule]) -> Slip:
    """
    Return the slip of a node that shows its numbers rounded too much.

    :param rule: builds the rule of a node that changes each number with the given function
    """
    return Slip.of(ROUNDED_IN_TEXT, *map(rule, ROUNDED))


def shown(inputs: Sequence[Any], numbers: Callable[[Any], Sequence[float]]) -> Specification:
    """
    Return the specification of log lines, of which each shows the number of one input.

    An answer has all numbers in the lines.

    :param numbers: returns the numbers of an input, of which its lines must show one
    """

    def rule(change: Change) -> Rule:
        return each(lambda one: tuple(map(change, numbers(one))))

    return Specification(inputs, rule(float), (rounded(rule),), like=near)


def why_not_numbered(
    texts: Sequence[str], place: int, first: int = 1, when: str = ''
) -> Cause | None:
    """
    Explain a text that lacks its number.

    :param texts: all texts, in order
    :param place: index of the first wrong text
    :param first: number of the first text; above 1 if earlier texts were lost
    :param when: what else happened just before the wrong text, such as ``a message arrives``
    """
    text, due = texts[place], first + place
    if '{' in text and '}' in text:
        return Cause(
            'no_f_string',
            'The string has no f in front of it, so Python shows its braces as they are.',
            "Write an f before the quotes, as in f'number {self.count}'.",
        )
    numbers = whole_numbers_in(text)
    if not numbers:
        return Cause('no_number', 'There is no number in the text.', "As in f'... {self.count}'.")
    if len(set(texts)) == 1:
        return Cause('never_counts', 'The number is the same in every text.', COUNT_IN)
    if place:
        changed = set(numbers) - set(whole_numbers_in(texts[place - 1]))
        if any(number < due for number in changed):
            return _why_back(due - 1, f' Just then, {when}.' if when else '')
        wrong = 'From one text to the next the number does not grow by 1.'
        return Cause('wrong_step', wrong, COUNT_IN)
    if due - 1 in numbers:
        return Cause('counts_from_zero', 'The count begins with 0.', 'Add 1 first, then use it.')
    return Cause(
        'begins_later',
        f'Text {due} has the number {numbers[0]}: the count does not begin with 1, or something '
        'counts that sends nothing.',
        'Begin with self.count = 0, and let the timer alone call the method that counts.',
    )


def _why_back(count: int, when: str) -> Cause:
    """
    Explain a number that goes back.

    :param count: number of texts before it
    :param when: what else happened just then, as a sentence
    """
    back = f'After {count} texts the numbers begin again'
    reset = f'The count goes back after {count} texts: something sets it again.{when}'
    return Cause(
        'begins_again',
        f'{back}.{when}',
        f'Write the count itself into the text, without % and cycle(). {COUNT_IN}',
        closer=[
            Cause('begins_again', reset, COUNT_IN, act='recount'),
            Cause(
                'begins_again',
                f'{back}: the text has the remainder of the count.',
                'Write the count itself into the text, and use % in the condition only.',
                act='wrapped_count',
            ),
            Cause(
                'begins_again',
                f'{back}: cycle() repeats them.',
                'Use itertools.count(1), or a count of your own.',
                act='cycle()',
            ),
        ],
    )
