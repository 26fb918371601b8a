"""
Programs keep time in forty-one ways: each message comes at its exact nanosecond.

The programs of ``time_styles.py`` run in the grader's real sandbox, with its probe beside them.
"""

from collections.abc import Sequence

import pytest

from autograder.exam.scenario import Advance, Feed, Scenario
from autograder.recording import Recording
from autograder.runs.observe import observe
from autograder.sandboxes.choose import strongest, usable
from autograder.sandboxes.sandbox import Sandbox
from tests.clock.time_styles import ANSWERING, BEGIN, STYLES

pytestmark = [pytest.mark.ros, pytest.mark.pipeline]
SECOND = 1_000_000_000
LATE_NS = SECOND // 16
COMMANDS = ('subprocess', 'os.system')
WATCHED = Scenario(file='style.py', watch={'/n': 'std_msgs/msg/Int32'}, steps=(Advance(19.8),))
ASKED = Scenario(
    file='style.py',
    watch={'/answer': 'std_msgs/msg/Float64'},
    feed={'/input': 'std_msgs/msg/Float64'},
    steps=(
        Feed('/input', [{'data': float(number)} for number in range(20)], every_s=0.5),
        Feed('/input', [{'data': float(number)} for number in range(20, 25)], burst=True),
    ),
)


def recording(body: str, scenario: Scenario, sandbox: Sandbox) -> Recording:
    inside = ''.join(f'    {line}\n' for line in body.splitlines())
    return observe('style', scenario.to_json(), {'style.py': BEGIN + inside}, sandbox)[0]


def numbers(found: Recording) -> list[tuple[int, int]]:
    """Return what came on the topic n: when [ns], and which number."""
    return [(one['clock_ns'], one['data']['data']) for one in found.messages('/n')]


def numbers_at(seconds: Sequence[float], first: int = 1) -> list[tuple[int, int]]:
    """Return numbers that come at some seconds."""
    return [(round(at * SECOND), n) for n, at in enumerate(seconds, start=first)]


@pytest.mark.parametrize('style', STYLES)
def test_style_is_exact(style: str) -> None:
    """Every number comes at the nanosecond that the program's text says."""
    body, seconds = STYLES[style]
    first = 2 if style == 'publish and sleep' else 1

    due = numbers_at(seconds, first)
    # The sleep command of coreutils 9.7 (Debian 13) asks for a nanosecond more than it is told.
    longer = [(at + number, number) for at, number in due] if style in COMMANDS else due
    assert numbers(recording(body, WATCHED, strongest())) in (due, longer)


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
