"""Find the drawn inputs of hidden exams, and texts that reveal them."""

from collections.abc import Iterator
import json
import re
from typing import Any

from autograder.exam import catalog
from autograder.exam.exam import Exam
from autograder.exam.steps import Advance, Call, Feed
from autograder.judging.causes.redaction import namespace_of, PUBLIC
from autograder.results import CheckResult

NAMES = catalog.names()
LEAST_DIGITS = 3
"""Numbers with fewer digits occur in any sentence: periods, counts, line numbers."""
_NUMBER = re.compile(r'(?<![\w.])\d+(?:\.\d+)?(?!\w)')
_WORD = re.compile(r'\w{3,}')


def texts_of(check: CheckResult) -> str:
    """Return all text about a check that a learner sees."""
    return '\n'.join((check.expected, check.observed, check.cause, check.try_this))


def revealed_values(exam: Exam, text: str) -> list[str]:
    """Return the drawn values, times and namespace that a text reveals."""
    words = {word.casefold() for word in _WORD.findall(text.replace('/', ' '))}
    spaces = (namespace_of(one).strip('/') for one in exam.scenario.starts)
    found = [space for space in spaces if space and space in text.casefold()]
    found += sorted(words & _secret_words(exam))
    numbers = [(float(one), one) for one in _NUMBER.findall(text) if _digits(one) >= LEAST_DIGITS]
    values, moments = list(_secret_numbers(exam)), list(_moments_s(exam))
    for number, token in numbers:
        decimals = len(token.partition('.')[2])
        # With one decimal, almost any number equals some moment of a long run.
        secrets = [*values, *moments] if decimals > 1 else values
        if any(round(abs(secret), decimals) == number for secret in secrets):
            found.append(token)
    return found


def _digits(token: str) -> int:
    return len(token.replace('.', '').lstrip('0'))


def _secret_words(exam: Exam) -> set[str]:
    public = {word.casefold() for word in PUBLIC}
    return _words(exam) - _words(catalog.load(exam.name, hidden=False)) - public


def _words(exam: Exam) -> set[str]:
    texts = [value for value in sent_by(exam) if isinstance(value, str)]
    return {word.casefold() for text in texts for word in _WORD.findall(text)}


def _secret_numbers(exam: Exam) -> Iterator[float]:
    """Yield the numbers that an exam sends, except those that every lesson shows."""
    public = {float(word) for word in PUBLIC if word.isdigit()} | {30.01, 30.004, 29.99}
    yield from _numbers(exam) - _numbers(catalog.load(exam.name, hidden=False)) - public


def _numbers(exam: Exam) -> set[float]:
    return {float(one) for one in sent_by(exam) if isinstance(one, (int, float))}


def _moments_s(exam: Exam) -> Iterator[float]:
    """Yield the drawn times of the ROS clock [s]."""
    if clock := exam.scenario.ros_clock:
        seconds = sum(step.seconds for step in exam.scenario.steps if isinstance(step, Advance))
        for number in range(round(seconds * clock.rate / clock.step_s)):
            yield clock.begins_s + number * clock.step_s


def sent_by(exam: Exam) -> Iterator[Any]:
    """Yield each string and number that an exam sends or sets."""
    for step in (step for one in exam.scenario.starts for step in one.steps):
        if isinstance(step, Feed):
            yield from _leaves([message for message in step.messages])
        elif isinstance(step, Call):
            yield from (one for one in _leaves(step.request) if isinstance(one, float))


def _leaves(value: Any) -> Iterator[Any]:
    if isinstance(value, str) and value.startswith('{'):  # a recorded run
        value = json.loads(value)
    if isinstance(value, dict):
        value = list(value.values())
    if not isinstance(value, list):
        yield value
        return
    for one in value:
        yield from _leaves(one)
