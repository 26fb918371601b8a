"""
A right rhythm keeps its points whatever keeps it, and a wrong one loses them, by the same exam.

Each style of ``time_styles.py`` is a talker twice: with the period that the exam asks for, and
with one that is a tenth of a second longer.
"""

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
# alarm() knows only whole seconds, and three styles keep no rhythm of their own.
OTHER = ('alarm', 'sleep longer than the period', 'node that ends by itself', 'lifespan')
LATE = ('sleep in a callback', 'sleep before the timer')  # a talker has to begin within 0.5 s
STYLES_OF_TALKERS = [name for name in STYLES if name not in OTHER]


def verdicts(style: str, period_s: float) -> dict[str, Verdict]:
    """Return what the exam says to a talker."""
    text = BEGIN.replace('P = 1.0', f'P = {period_s}')
    for before, after in TALKS.items():
        assert before in text
        text = text.replace(before, after)
    body = ''.join(f'    {line}\n' for line in STYLES[style][0].splitlines())
    result = examine(
        catalog.load('talker', hidden=False), {'talker.py': text + body}, sandbox=strongest()
    )
    return {check.check: check.verdict for check in result.checks}


@pytest.mark.parametrize('style', STYLES_OF_TALKERS)
def test_right_rhythm_keeps_its_points(style):
    """By timers, sleeps, threads, signals, processes and polls."""
    found = verdicts(style, RIGHT_S)

    lost = {name for name, verdict in found.items() if verdict is not Verdict.PASSED}
    assert lost == ({'speaks_twice_a_second'} if style in LATE else set())


@pytest.mark.parametrize('style', STYLES_OF_TALKERS)
def test_wrong_rhythm_loses_them(style):
    """A tenth of a second too slow, for that reason and for no other."""
    found = verdicts(style, WRONG_S)

    lost = {name for name, verdict in found.items() if verdict is not Verdict.PASSED}
    assert lost == {'speaks_twice_a_second'}


def test_callback_that_sleeps_longer_than_its_period_is_too_slow():
    """A timer of half a second whose callback sleeps for two: a message every two seconds."""
    found = verdicts('sleep longer than the period', RIGHT_S)

    assert found['speaks_twice_a_second'] is Verdict.FAILED
