"""
What an exam asks of each of its inputs: rows of what followed, compared with what was due.

What is due, and which slip explains something else, is a
:class:`autograder.exam.specification.Specification`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from typing import Any

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.slips import FALSE_ALARM, MISSED_WARNING, REPEATED
from autograder.exam.specification import Specification
from autograder.judging.causes.ended import why_silent
from autograder.judging.checks import count_of
from autograder.recording import Event, WARN

Row = list[Event]


def rows(run: Run, events: Iterable[Event], count: int, burst: int = 0) -> list[Row | None]:
    """
    Return the events that followed each input.

    :param events: of the run, each with the number of the input that it follows
    :param count: how many inputs the exam has
    :param burst: how many of the last ones come at once: they have one row
    :returns: None in place of a row whose input was not sent, or not all of the burst
    """
    found: list[Row] = [[] for _ in range(count)]
    for event in events:
        if event['after_input'] is not None:
            found[event['after_input']].append(event)
    sent = len(run.recording.of('input'))
    singles: list[Row | None] = [
        row if place < sent else None for place, row in enumerate(found[: count - burst])
    ]
    if not burst:
        return singles
    together = [event for row in found[count - burst :] for event in row]
    return [*singles, together if sent == count else None]


def require_warnings(
    run: Run,
    asked: Specification,
    followed: Sequence[Row | None],
    places: Collection[int],
    why_missing: Callable[[int], Cause | None],
    part: Collection[int] = (),
    shared: bool = False,
) -> None:
    """
    Fail unless inputs are followed by as many WARN lines as are due.

    :param asked: what is due; its inputs have ``kind``, words for what they try
    :param followed: log lines after each input, see :func:`rows`
    :param places: of the inputs that the check is about
    :param why_missing: explains a warning that did not come, None if only its rule does
    :param part: places on which one mistake may explain all, see ``Specification.cause``
    :param shared: see :func:`share`
    """
    came = [row if row is None else _warnings(row) for row in followed]
    wrong = [place for place in places if (came[place] or 0) != asked.answers[place]]
    if not wrong:
        return
    place = wrong[0]
    due, count = asked.answers[place], came[place] or 0
    short = count < due
    repeats = any((one or 0) > len(asked.row(row)) for row, one in enumerate(came))
    other = MISSED_WARNING if short else REPEATED if repeats else FALSE_ALARM
    due_lines = f'{count_of(due)} WARN line{"" if due == 1 else "s"}'
    raise Failed(
        expected=f'{due_lines} after {_what(asked.row(place))}',
        observed='the run ended before it was sent'
        if came[place] is None
        else f'{count_of(count)} WARN line{"" if count == 1 else "s"}',
        why=why_silent(run)
        or (why_missing(place) if short else None)
        or asked.cause(came, place, part)
        or other,
        share=share(run, followed, len(places) - len(wrong), len(places)) if shared else 0.0,
    )


def share(run: Run, followed: Sequence[Row | None], right: int, due: int) -> float:
    """
    Return the part of the points for what was right before a program ended in mid-run.

    How far a program came until the limit of processor time is the machine's doing: no part of it.
    """
    if None not in followed or run.recording.end_reason == 'cpu_limit' or not due:
        return 0.0
    return round(right / due, 2)


def _what(inputs: Sequence[Any]) -> str:
    return f'a burst of {len(inputs)} readings' if len(inputs) > 1 else str(inputs[0].kind)


def _warnings(row: Row) -> int:
    return sum(line['level'] == WARN for line in row)
