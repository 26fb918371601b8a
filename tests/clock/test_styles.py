"""
Programs keep time in many ways: each message and log line arrives at its exact nanosecond.

The programs of ``time_styles.py`` run in the grader's real sandbox, together with its probe.
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
    """Return the time [ns] and the number of each message on the topic n."""
    return [(one['clock_ns'], one['data']['data']) for one in found.messages('/n')]


def numbers_at(seconds: Sequence[float], first: int = 1) -> list[tuple[int, int]]:
    """Return consecutive numbers, each with its time [ns]."""
    return [(round(at * SECOND), n) for n, at in enumerate(seconds, start=first)]


@pytest.mark.parametrize('style', STYLES)
def test_style_is_exact(style: str) -> None:
    """Every number and every log line arrives at the exact nanosecond that the code implies."""
    body, seconds = STYLES[style]
    first = 2 if style == 'publish and sleep' else 1

    with early_limits() if ENDS.get(style) == 'cpu_limit' else nullcontext():
        found = recording(body, WATCHED, strongest())

    due = numbers_at(seconds, first)
    # The sleep command of coreutils 9.7 (Debian 13) sleeps a nanosecond longer than requested.
    longer = [(at + number, number) for at, number in due] if style in COMMANDS else due
    assert numbers(found) in (due, longer)
    logged = [(one['clock_ns'], one['text']) for one in found.of('log')]
    assert logged == [(round(at * SECOND), text) for at, text in LOGS.get(style, ())]
    assert found.end_reason == ENDS.get(style, 'complete')


@pytest.mark.parametrize('style', ANSWERING)
def test_answers_come_at_the_instant_of_their_input(style: str) -> None:
    """Bursts are included; late answers follow one another with exactly the program's delay."""
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
    """These modes share the network, but not the clock."""
    body, seconds = STYLES['timer']

    assert numbers(recording(body, WATCHED, usable(mode))) == numbers_at(seconds)
