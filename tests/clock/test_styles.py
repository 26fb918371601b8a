"""
Programs keep time in many ways: each message and log line comes at its exact nanosecond.

The programs of ``time_styles.py`` run in the grader's real sandbox, with its probe beside them.
"""

from collections.abc import Sequence
from contextlib import nullcontext

import pytest

from autograder.exam.scenario import Scenario
from autograder.recording import Recording
from autograder.runs.observe import observe
from autograder.sandboxes.choose import strongest, usable
from autograder.sandboxes.sandbox import Sandbox
from tests.attacks.corpus import early_limits
from tests.clock.time_styles import ANSWERING, ASKED, ENDS, LOGS, program, STYLES, WATCHED

pytestmark = [pytest.mark.ros, pytest.mark.pipeline]
SECOND = 1_000_000_000
LATE_NS = SECOND // 16
COMMANDS = ('subprocess', 'os.system')


def recording(body: str, scenario: Scenario, sandbox: Sandbox) -> Recording:
    return observe('style', scenario.to_json(), {'style.py': program(body)}, sandbox)[0]


def numbers(found: Recording) -> list[tuple[int, int]]:
    """Return what came on the topic n: when [ns], and which number."""
    return [(one['clock_ns'], one['data']['data']) for one in found.messages('/n')]


def numbers_at(seconds: Sequence[float], first: int = 1) -> list[tuple[int, int]]:
    """Return numbers that come at some seconds."""
    return [(round(at * SECOND), n) for n, at in enumerate(seconds, start=first)]


@pytest.mark.parametrize('style', STYLES)
def test_style_is_exact(style: str) -> None:
    """Every number comes at the nanosecond that the program's text says, and every log line."""
    body, seconds = STYLES[style]
    first = 2 if style == 'publish and sleep' else 1

    with early_limits() if ENDS.get(style) == 'cpu_limit' else nullcontext():
        found = recording(body, WATCHED, strongest())

    due = numbers_at(seconds, first)
    # The sleep command of coreutils 9.7 (Debian 13) asks for a nanosecond more than it is told.
    longer = [(at + number, number) for at, number in due] if style in COMMANDS else due
    assert numbers(found) in (due, longer)
    logged = [(one['clock_ns'], one['text']) for one in found.of('log')]
    assert logged == [(round(at * SECOND), text) for at, text in LOGS.get(style, ())]
    assert found.end_reason == ENDS.get(style, 'complete')


@pytest.mark.parametrize('style', ANSWERING)
def test_answers_come_at_the_instant_of_their_input(style: str) -> None:
    """Bursts included; late ones exactly as late as the program says, one after the other."""
    found = recording(ANSWERING[style], ASKED, strongest())

    due, free_ns = [], 0
    for sent in found.of('input'):
        free_ns = max(free_ns, sent['clock_ns']) + (LATE_NS if style == 'late' else 0)
        due.append((free_ns, 2 * sent['data']['data']))
    came = [(one['clock_ns'], one['data']['data']) for one in found.messages('/answer')]
    said = [(one['clock_ns'], 2 * float(one['text'].split()[1])) for one in found.of('log')]
    assert len(due) == 25
    assert (sorted(came), sorted(said)) == (due, due)


@pytest.mark.parametrize('mode', ['none', 'landlock'])
def test_weaker_modes_are_as_exact(mode: str) -> None:
    """The network is shared there; the clock is not."""
    body, seconds = STYLES['timer']

    assert numbers(recording(body, WATCHED, usable(mode))) == numbers_at(seconds)
