"""
Find the moment in a recording at which a check first observed a deviation.

A check reports only what it expected and observed, and it may name the moment
(``Failed(at=...)``).  Otherwise a binary search finds the shortest part of the recording, from its
start, for which the check fails with the same message.
"""

from bisect import bisect_left
from dataclasses import dataclass, replace

from autograder.exam.exam import Check, Failed, Run
from autograder.recording import Recording

TAIL = ('graph', 'end', 'process')


@dataclass(frozen=True)
class Deviation:
    """
    A moment of a run.

    :param index: index of an event in the recording
    :param how: how the moment was found: ``named`` by the check, ``cut`` by shortening the
        recording, ``ended`` if the run ended early, or ``end`` if only the whole run shows it
    """

    index: int
    how: str


def deviation(check: Check, run: Run) -> Deviation | None:
    """
    Return the moment at which a check first observed a deviation.

    Return None if the check passes or is static, or if the recording is empty.
    """
    events = run.recording.events
    failure = failure_of(check, run)
    if failure is None or check.static or not events:
        return None
    regular = [n for n, event in enumerate(events) if event['event'] not in TAIL] or [0]
    if failure.at is not None:
        moments = ((n, events[n].get('clock_ns')) for n in regular)
        later = (n for n, moment in moments if moment is not None and moment >= failure.at)
        return Deviation(next(later, regular[-1]), 'named')
    if run.recording.end_reason != 'complete':
        ends = [n for n, event in enumerate(events) if event['event'] == 'end']
        return Deviation((ends or [len(events) - 1])[-1], 'ended')
    index = _shortest(check, run, failure)
    return Deviation(index, 'cut') if index < regular[-1] else Deviation(regular[-1], 'end')


def failure_of(check: Check, run: Run) -> Failed | None:
    """Return the failure of a check, None if it passes."""
    try:
        check.judge(run)
    except Failed as failure:
        return failure
    return None


def _shortest(check: Check, run: Run, failure: Failed) -> int:
    """Return the index of the last event of the shortest part with the same failure."""
    events = run.recording.events
    body = len(events)
    while body and events[body - 1]['event'] in TAIL:
        body -= 1

    def fails_alike(count: int) -> bool:
        cut = Recording(run.recording.header, [*events[:count], *events[body:]])
        try:
            found = failure_of(check, replace(run, recording=cut))
        except Exception:  # noqa: BLE001 - a check may break on part of a recording
            return False
        same = found and (found.expected, found.observed) == (failure.expected, failure.observed)
        return bool(same)

    return max(0, bisect_left(range(body), True, key=fails_alike) - 1)
