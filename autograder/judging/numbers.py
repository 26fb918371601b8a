"""Read numbers in log lines and messages, and explain wrong numbering."""

from collections.abc import Callable, Iterable, Sequence
import math
import re
from typing import Any

from autograder.exam.exam import Cause
from autograder.exam.slips import Change
from autograder.exam.specification import each, Rule, Slip, Specification
from autograder.judging.causes.text_table import cause_of

COUNT_IN = (
    'Set self.count = 0 once, in __init__(). In the callback, add 1 once, then build the text.'
)
_NUMBER = re.compile(
    r'[-+]?(?:\d+(?:[.,]\d+)?(?:e[-+]?\d+)?|\b(?:nan|inf(?:inity)?)\b)', re.IGNORECASE
)
GRAIN = 0.051
"""Maximum difference between a value and a number that shows it to at least one decimal."""


def numbers_in(text: str) -> list[float]:
    """Return the signed numbers in a text, even NaN and infinity; a comma may mark decimals."""
    return [float(found.replace(',', '.')) for found in _NUMBER.findall(text)]


def whole_numbers_in(text: str) -> list[int]:
    """Return the groups of digits in a text as integers: 003 is 3; digits of all scripts count."""
    return [int(digits) for digits in re.findall(r'\d{1,9}', text)]


ROUNDED: tuple[Change, ...] = (
    lambda number: math.modf(number)[1],  # int()
    *(lambda number, to=to: float(format(number, to)) for to in ('.0f', '.1g', '.2g', '.3g')),
)
"""Ways of rounding a number too coarsely for a log line."""


def near(some: Iterable[float], others: Sequence[float], grain: float = GRAIN) -> bool:
    """Return whether a number from one list equals one from the other, within a tolerance."""
    return any(
        abs(one - other) <= grain or one == other or (math.isnan(one) and math.isnan(other))
        for one in some
        for other in others
    )


def shows(text: str, *values: float) -> bool:
    """Return whether a text shows one of several values, within :data:`GRAIN`."""
    return near(values, numbers_in(text))


def rounded(rule: Callable[[Change], Rule]) -> Slip:
    """Return the slip of a node that rounds its numbers too coarsely in log lines."""
    return Slip.of(cause_of('rounded_in_text'), *map(rule, ROUNDED))


def shown(inputs: Sequence[Any], numbers: Callable[[Any], Sequence[float]]) -> Specification:
    """
    Return the specification of log lines that each show the number of one input.

    The recorded answer to an input is the list of all numbers in its log lines.

    :param numbers: returns the numbers of an input; its log lines must show one of them
    """

    def rule(change: Change) -> Rule:
        return each(lambda one: tuple(map(change, numbers(one))))

    return Specification(inputs, rule(float), (rounded(rule),), like=near)


def why_not_numbered(
    texts: Sequence[str], place: int, first: int = 1, when: str = ''
) -> Cause | None:
    """
    Explain a message or log line that lacks its number.

    :param texts: all messages or lines, in order
    :param place: index of the first wrong one
    :param first: number of the first one; above 1 if earlier ones were lost
    :param when: what else happened just before the wrong one, such as ``a message arrives``
    """
    text, due = texts[place], first + place
    if '{' in text and '}' in text:
        return cause_of('no_f_string')
    numbers = whole_numbers_in(text)
    if not numbers:
        return cause_of('number_missing' if any(map(whole_numbers_in, texts)) else 'no_number')
    if len(set(texts)) == 1:
        return cause_of('never_counts', repair=COUNT_IN)
    if not place and due - 1 in numbers:
        return cause_of('counts_from_zero')
    before = texts[place - 1] if place else ''
    if place and whole_numbers_in(before) == numbers:
        return cause_of('same_number', due=due)
    if all(number >= due for number in set(numbers) - set(whole_numbers_in(before))):
        situation = 'wrong_step' if place else 'begins_later'
        return cause_of(situation, due=due, number=numbers[0], repair=COUNT_IN)
    moment = f' Just then, {when}.' if when else ''
    return cause_of('begins_again', count=due - 1, when=moment, repair=COUNT_IN)
