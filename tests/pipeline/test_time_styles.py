"""
Test that one exam accepts a right rhythm in any style of keeping time, and rejects a wrong one.

``tests/clock/test_styles.py`` shows that each of forty styles is exact to the nanosecond.  Here,
one style of each kind is used in a talker twice: with the period that the exam requires, and with
a period that is 10 % longer.
"""

from __future__ import annotations

import pytest

from autograder.exam import catalog
from autograder.grading.examine import examine
from autograder.results import Verdict
from autograder.sandboxes.choose import strongest
from tests.clock.time_styles import BEGIN, STYLES

pytestmark = [pytest.mark.ros, pytest.mark.pipeline, pytest.mark.slow]
RIGHT_S, WRONG_S = 0.5, 0.6
TALKS = {
    "'numbers'": "'talker'",
    "Int32, 'n', 10": "String, 'chatter', 10",
    'self.publisher.publish(Int32(data=self.number))': (
        "self.publisher.publish(String(data=f'hello {self.number}'))"
    ),
    'import Float64, Int32': 'import Float64, Int32, String',
}
KINDS = (
    'timer',
    'create_rate',
    'asyncio',
    'setitimer',
    'multiprocessing.Queue',
    'polling now()',
    'sleep in a callback',
)


def verdicts(style: str, period_s: float) -> dict[str, Verdict]:
    """Return the verdicts of the exam for a talker."""
    text = BEGIN.replace('P = 1.0', f'P = {period_s}')
    for before, after in TALKS.items():
        assert before in text
        text = text.replace(before, after)
    body = ''.join(f'    {line}\n' for line in STYLES[style][0].splitlines())
    result = examine(catalog.load('talker'), {'talker.py': text + body}, sandbox=strongest())
    return {check.check: check.verdict for check in result.checks}


@pytest.mark.parametrize('style', KINDS)
def test_right_rhythm_keeps_its_points(style):
    """The styles are timers, threads, coroutines, signals, processes and polls."""
    found = verdicts(style, RIGHT_S)

    assert {name for name, verdict in found.items() if verdict is not Verdict.PASSED} == set()


@pytest.mark.parametrize('style', KINDS)
def test_wrong_rhythm_loses_them(style):
    """The rhythm is 10 % too slow, and only the check of the rhythm fails."""
    found = verdicts(style, WRONG_S)

    lost = {name for name, verdict in found.items() if verdict is not Verdict.PASSED}
    assert lost == {'speaks_twice_a_second'}


def test_callback_that_sleeps_longer_than_its_period_is_too_slow():
    """A 0.5 s timer whose callback sleeps for 2 s gives a message every two seconds."""
    found = verdicts('sleep longer than the period', RIGHT_S)

    assert found['speaks_twice_a_second'] is Verdict.FAILED
