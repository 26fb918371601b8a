"""
Find the moment in a recording at which a check saw something unexpected.

A check says only what it expected and what it observed.  It may name the moment
(``Failed(at=...)``).  Else the recording is cut shorter and shorter, and the moment is where the
same words come out for the first time.
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

    :param index: of the event in the recording
    :param how: how it was found: ``named``, ``cut``, ``ended`` if the run broke off, or ``end`` if
        only the whole run shows it
    """

    index: int
    how: str


def deviation(check: Check, run: Run) -> Deviation | None:
    """
    Return where a check first saw something else, None if it passes or looks at files alone.

    :param run: the files and the recording
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
    """Return how a check fails, None if it passes."""
    try:
        check.judge(run)
    except Failed as failure:
        return failure
    return None


def _index_at(events: Sequence[Event], at: int) -> int:
    """Return the first event at or after a virtual time, or the last one before the end."""
    for number, event in enumerate(events):
        clock = event.get('clock_ns')
        if clock is not None and clock >= at and event['event'] not in TAIL:
            return number
    return _last_before_the_end(events)


def _shortest(check: Check, run: Run, failure: Failed) -> int:
    """Return the last event of the shortest beginning that brings the same words."""
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
        except Exception:  # noqa: BLE001 - a check need not bear half a recording
            found = None
        words = found and (found.expected, found.observed)
        same = words == (failure.expected, failure.observed)
        short, long = (short, middle) if same else (middle + 1, long)
    return max(0, long - 1)
