"""Read numbers in log lines and messages, and explain wrong numbering."""

from __future__ import annotations

from collections.abc import Sequence
import re

from autograder.exam.exam import Cause

COUNT_IN = 'Make self.count once, in __init__(), as 0, and add 1 in the callback, once.'
_NUMBER = re.compile(r'[-+]?\d+(?:[.,]\d+)?(?:[eE][-+]?\d+)?')
GRAIN = 0.051
"""Maximum difference between a value and its number in a text, which may have one decimal."""


def numbers_in(text: str) -> list[float]:
    """Return the numbers in a text, with their signs; a comma may be the decimal separator."""
    return [float(found.replace(',', '.')) for found in _NUMBER.findall(text)]


def whole_numbers_in(text: str) -> list[int]:
    """Return the groups of digits in a text as integers: 003 is 3; digits of all scripts count."""
    return [int(digits) for digits in re.findall(r'\d{1,9}', text)]


ROUNDED_IN_TEXT = Cause(
    'rounded_in_text',
    'Your line shows the number without its decimals.',
    'Log the number as it is, without int(), round() and a format such as :.0f.',
)


def is_rounded_in(text: str, value: float) -> bool:
    """Return whether a text shows a value without its decimals, and not the value itself."""
    near = [one for one in numbers_in(text) if abs(one - value) < 1]
    return bool(near) and all(one != value and one == int(one) for one in near)


def shows(text: str, *values: float) -> bool:
    """Return whether a text shows one of some values, with any rounding."""
    return any(abs(one - value) <= GRAIN for one in numbers_in(text) for value in values)


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
            'The text has braces in it: they are filled in only if an f stands before the quotes.',
            "Write an f before the quotes, as in f'number {self.count}'.",
        )
    numbers = whole_numbers_in(text)
    if not numbers:
        return Cause('no_number', 'There is no number in the text.', "As in f'... {self.count}'.")
    if len(set(texts)) == 1:
        return Cause('never_counts', 'The number is the same in every text.', COUNT_IN)
    if place:
        before = {number for one in texts[:place] for number in whole_numbers_in(one)}
        if before & set(numbers) and text != texts[place - 1]:
            again = f'The count goes back after {place} texts: something sets it again.'
            again = f'{again} Just then, {when}.' if when else again
            return Cause('begins_again', again, COUNT_IN)
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
