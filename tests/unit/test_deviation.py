"""Find the event that makes a check fail, from the check or by shortening the recording."""

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


def test_check_that_goes_through_the_events_gives_up_at_one():
    """The first event that fails the check is the deviation; later events do not change it."""
    found = where(all_small, message(1, 1), message(2, 9), message(3, 9), message(4, 1))

    assert (found.index, found.how) == (1, 'cut')


def test_a_check_may_name_the_moment():
    def named(run):
        raise Failed(expected='a', observed='b', at=2 * 10**9)

    found = where(named, message(1, 1), message(2, 9), message(3, 9))

    assert (found.index, found.how) == (1, 'named')


def test_else_the_shortest_beginning_with_the_same_words_counts():
    """The deviation is the last event of the shortest run that fails with the same message."""
    found = where(enough, *(message(second, 1) for second in range(10)))

    assert (found.index, found.how) == (2, 'cut')


def test_what_is_missing_is_shown_by_the_whole_run_only():
    """A missing message has no event: until the end of the run, it could still arrive."""

    def last(run):
        count = len(run.recording.messages('/t'))
        raise Failed(expected='60', observed=f'{count}')

    found = where(last, message(1, 1), message(2, 1))

    assert (found.index, found.how) == (1, 'end')


def test_a_run_that_broke_off_deviates_where_it_ended():
    """A run that broke off deviates at its end, not before its first message."""

    def never(run):
        raise Failed(expected='60', observed='the run ended before')

    broken = {'event': 'end', 'clock_ns': 9, 'reason': 'student_exited'}
    found = where(never, message(1, 1), message(2, 1), end=(broken, END[1]))

    assert (found.index, found.how) == (2, 'ended')


def test_a_check_that_passes_or_looks_at_files_has_no_moment():
    """A check that passes, or that reads files, has no deviation."""
    assert where(all_small, message(1, 1)) is None
    assert where(enough, *(message(1, 1) for _ in range(5)), static=True) is None


def test_a_check_that_cannot_bear_half_a_recording_is_asked_no_more():
    def brittle(run):
        found = run.recording.messages('/t')
        assert found[3]
        raise Failed(expected='a', observed='b')

    found = where(brittle, *(message(second, 1) for second in range(8)))

    assert found.index == 3
