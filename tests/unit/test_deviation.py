"""Find the event that makes a check fail, from the check or by shortening the recording."""

import pytest

from autograder.exam.exam import Check, Failed, Run
from autograder.judging.judge import deviation
from autograder.recording import header, Recording


def message(second, value):
    facts = {'topic': '/t', 'data': {'value': value}}
    return {'event': 'message', 'clock_ns': second * 10**9, 'after_input': None, **facts}


END = ({'event': 'end', 'clock_ns': 9, 'reason': 'complete'}, {'event': 'process', 'exit': None})


def where(judge, *events, end=END, static=False):
    """Return where a check deviates in a run with these events."""
    run = Run({}, Recording(header('x', 'none'), [*events, *end]))
    return deviation(Check('c', 'C.', 1, judge, static=static), run)


def all_small(run):
    """Fail at the first message that is too large."""
    for one in run.recording.messages('/t'):
        if one['data']['value'] > 5:
            raise Failed(expected='small', observed='large')


def enough(run):
    """Fail if there are more than two messages."""
    if len(run.recording.messages('/t')) > 2:
        raise Failed(expected='at most 2', observed='more')


def named(run):
    raise Failed(expected='a', observed='b', at=2 * 10**9)


def last(run):
    raise Failed(expected='60', observed=f'{len(run.recording.messages("/t"))}')


def never(run):
    """Fail with the same words for every recording."""
    raise Failed(expected='60', observed='the run ended before')


def brittle(run):
    """Fail if the recording is long enough, or else break."""
    assert run.recording.messages('/t')[3]
    raise Failed(expected='a', observed='b')


BROKEN_OFF = ({'event': 'end', 'clock_ns': 9, 'reason': 'student_exited'}, END[1])


@pytest.mark.parametrize(
    ('judge', 'values', 'end', 'place'),
    [
        pytest.param(all_small, [1, 9, 9, 1], END, (1, 'cut'), id='at the first wrong event'),
        pytest.param(named, [1, 9, 9], END, (1, 'named'), id='at the moment of the check'),
        pytest.param(enough, [1] * 10, END, (2, 'cut'), id='where the words are the same'),
        # Until the end of the run, a missing message could still arrive.
        pytest.param(last, [1, 1], END, (1, 'end'), id='what is missing has no event'),
        pytest.param(never, [1, 1], BROKEN_OFF, (2, 'ended'), id='where a run broke off'),
    ],
)
def test_deviation_is_the_event_that_makes_the_check_fail(judge, values, end, place):
    found = where(judge, *(message(one, value) for one, value in enumerate(values, 1)), end=end)

    assert (found.index, found.how) == place


def test_a_check_that_passes_or_looks_at_files_has_no_moment():
    assert where(all_small, message(1, 1)) is None
    assert where(enough, *(message(1, 1) for _ in range(5)), static=True) is None


def test_a_check_that_cannot_bear_half_a_recording_is_asked_no_more():
    assert where(brittle, *(message(second, 1) for second in range(8))).index == 3
