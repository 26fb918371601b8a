"""
Find the moment in a recording at which a check first observed a deviation.

A check reports only what it expected and observed, and it may name the moment
(``Failed(at=...)``).  Otherwise a binary search finds the shortest part of the recording, from its
start, for which the check fails with the same words.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from autograder.exam.exam import Check, Failed, Run
from autograder.recording import Event, Recording

TAIL = ('graph', 'end', 'process')


@dataclass(frozen=True)
class Deviation:
    """
    A moment of a run.

    :param index: index of an event in the recording
    :param how: how it was found: ``named`` by the check, ``cut`` by shortening the recording,
        ``ended`` if the run ended early, or ``end`` if only the whole run shows the deviation
    """

    index: int
    how: str


def deviation(check: Check, run: Run) -> Deviation | None:
    """
    Return the moment at which a check first observed a deviation.

    None if the check passes or is static, or if the recording is empty.
    """
    events = run.recording.events
    failure = failure_of(check, run)
    if failure is None or check.static or not events:
        return None
    if failure.at is not None:
        return Deviation(_index_at(events, failure.at), 'named')
    if run.recording.end_reason != 'complete':
        ends = [n for n, event in enumerate(events) if event['event'] == 'end']
        return Deviation(ends[-1] if ends else len(events) - 1, 'ended')
    index, last = _shortest(check, run, failure), _last_before_the_end(events)
    return Deviation(index, 'cut') if index < last else Deviation(last, 'end')


def _last_before_the_end(events: Sequence[Event]) -> int:
    return max((n for n, event in enumerate(events) if event['event'] not in TAIL), default=0)


def failure_of(check: Check, run: Run) -> Failed | None:
    """Return the failure of a check, None if it passes."""
    try:
        check.judge(run)
    except Failed as failure:
        return failure
    return None


def _index_at(events: Sequence[Event], at: int) -> int:
    """Return the index of the first event from a virtual time on, or of the last regular one."""
    for number, event in enumerate(events):
        clock = event.get('clock_ns')
        if clock is not None and clock >= at and event['event'] not in TAIL:
            return number
    return _last_before_the_end(events)


def _shortest(check: Check, run: Run, failure: Failed) -> int:
    """Return the index of the last event of the shortest part with the same failure."""
    events = run.recording.events
    body = len(events)
    while body and events[body - 1]['event'] in TAIL:
        body -= 1
    short, long = 0, body
    while short < long:
        middle = (short + long) // 2
        try:
            cut = Recording(run.recording.header, [*events[:middle], *events[body:]])
            found = failure_of(check, replace(run, recording=cut))
        except Exception:  # noqa: BLE001 - a check may break on half a recording
            found = None
        words = found and (found.expected, found.observed)
        same = words == (failure.expected, failure.observed)
        short, long = (short, middle) if same else (middle + 1, long)
    return max(0, long - 1)
