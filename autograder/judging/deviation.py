"""
Where in a recording a check saw something else than it asks for.

A check says only what it expected and what it observed.  Three ways lead from there to a moment,
the surest first: the check names it (``Failed(at=...)``); the check went through the events in
order and gave up at one; or the recording is cut shorter and shorter, and the moment is where the
same words come out for the first time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
import sys
from typing import Any

from autograder.exam.exam import Check, Failed, Run
from autograder.recording import Event, Recording

TAIL = ('graph', 'end', 'process')
MOMENTS = ('message', 'log', 'answer', 'no_answer', 'joined', 'offered')


@dataclass(frozen=True)
class Deviation:
    """
    A moment of a run.

    :param index: of the event in the recording
    :param how: how it was found: ``named``, ``looked_at``, ``cut``, ``ended`` if the run broke
        off, or ``end`` if only the whole run shows it
    """

    index: int
    how: str


def deviation(check: Check, run: Run) -> Deviation | None:
    """
    Return where a check first saw something else, None if it passes or looks at files alone.

    :param run: the files and the recording
    """
    events = run.recording.events
    looked: list[int] = []
    noted = [_Noting(event, number, looked) for number, event in enumerate(events)]
    failure = _failure(check, run, noted)
    if failure is None or check.static or not events:
        return None
    if failure.at is not None:
        return Deviation(_index_at(events, failure.at), 'named')
    graphs = [number for number in looked if events[number]['event'] == 'graph']
    others = [number for number in looked if events[number]['event'] != 'graph']
    if others and _gave_up_at(events, others[-1]):
        return Deviation(others[-1], 'looked_at')
    if run.recording.end_reason != 'complete':
        ends = [n for n, event in enumerate(events) if event['event'] == 'end']
        return Deviation(ends[-1] if ends else len(events) - 1, 'ended')
    index = _shortest(check, run, _words(failure))
    last = max((n for n, event in enumerate(events) if event['event'] not in TAIL), default=0)
    if index < last:
        return Deviation(index, 'cut')
    return Deviation(graphs[-1], 'looked_at') if graphs else Deviation(last, 'end')


class _Noting(dict[str, Any]):
    """An event that notes when a check, and not a recording's own filter, looks at it."""

    def __init__(self, event: Event, number: int, looked: list[int]) -> None:
        super().__init__(event)
        self.number, self.looked = number, looked

    def __getitem__(self, key: str) -> Any:
        self._note(key)
        return super().__getitem__(key)

    def get(self, key: str, default: Any = None) -> Any:
        self._note(key)
        return super().get(key, default)

    def _note(self, key: str) -> None:
        frame = sys._getframe(2)  # who asks: the check, or what helps it
        # A recording's filters look at every event, but into a graph only for a check.
        filters = frame.f_globals.get('__name__') == Recording.__module__
        if filters and key not in ('nodes', 'endpoints'):
            return
        walked: Any = frame
        while walked is not None and walked.f_globals.get('__name__') != __name__:
            if 'why' in walked.f_code.co_name or 'cause' in walked.f_code.co_name:
                return  # it looks for a reason, after the fact
            walked = walked.f_back
        self.looked.append(self.number)


def _failure(check: Check, run: Run, events: list[Any]) -> Failed | None:
    recording = Recording(run.recording.header, events)
    try:
        check.judge(Run(run.files, recording, run.facts))
    except Failed as failure:
        return failure
    return None


def _index_at(events: Any, at: int) -> int:
    """Return the first event at or after a virtual time, or the last one before the end."""
    for number, event in enumerate(events):
        clock = event.get('clock_ns')
        if clock is not None and clock >= at and event['event'] not in TAIL:
            return number
    return max((n for n, event in enumerate(events) if event['event'] not in TAIL), default=0)


def _gave_up_at(events: Any, index: int) -> bool:
    """Tell whether more of the same came after an event, so that a check stopped there."""
    event = events[index]
    return event['event'] in MOMENTS and any(
        later['event'] == event['event'] and later.get('topic') == event.get('topic')
        for later in events[index + 1 :]
    )


def _words(failure: Failed) -> tuple[str, str]:
    return failure.expected, failure.observed


def _shortest(check: Check, run: Run, words: tuple[str, str]) -> int:
    """Return the last event of the shortest beginning that brings the same words."""
    events = list(run.recording.events)
    body = len(events)
    while body and events[body - 1]['event'] in TAIL:
        body -= 1
    tail = events[body:]
    short, long = 0, body
    while short < long:
        middle = (short + long) // 2
        same = _same_words(check, run, [*events[:middle], *tail], words)
        short, long = (short, middle) if same else (middle + 1, long)
    return max(0, long - 1)


def _same_words(
    check: Check, run: Run, events: list[Mapping[str, Any]], words: tuple[str, str]
) -> bool:
    try:
        failure = _failure(check, run, events)
    except Exception:  # noqa: BLE001 - a check need not bear half a recording
        return False
    return failure is not None and _words(failure) == words
