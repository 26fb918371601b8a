"""
Log lines that are due after inputs: how many come, and which show their number.

The lines that follow an input, or a burst of them, are a row, see
:mod:`autograder.judging.rows`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.slips import FALSE_ALARM, MISSED_WARNING, REPEATED
from autograder.exam.specification import Specification
from autograder.judging.causes.ended import why_silent
from autograder.judging.causes.missing_logs import why_not_logged
from autograder.judging.checks import lines
from autograder.judging.rows import Row, rows
from autograder.recording import INFO, WARN


@dataclass(frozen=True)
class Followed:
    """
    Inputs that go together, and the log lines that followed them.

    :param inputs: one, or all of a burst; each tells with ``is_in`` whether a text shows it
    :param row: None if the run ended before
    """

    inputs: Sequence[Any]
    row: Row | None

    @property
    def logs(self) -> Row:
        """Return the lines that followed."""
        return self.row or []

    def count(self, level: int) -> int:
        """Return how many lines have a level."""
        return sum(entry['level'] == level for entry in self.logs)

    def showing(self, one: Any, level: int = INFO) -> int:
        """Return how many lines of a level show an input."""
        return sum(one.is_in(entry['text']) for entry in self.logs if entry['level'] == level)


def followed(run: Run, ask: str) -> list[Followed]:
    """Pair every input of a specification, sent or not, with what was logged after it."""
    found = rows(run, ask, run.recording.logs())
    return [Followed(run.asked(ask).row(place), row) for place, row in enumerate(found)]


def require_warnings(
    run: Run,
    asked: Specification,
    followed: Sequence[Row | None],
    places: Collection[int],
    part: Collection[int] = (),
    why_missing: Callable[[int], Cause | None] | None = None,
    shared: bool = False,
) -> None:
    """
    Fail unless inputs are followed by as many WARN lines as are due.

    :param asked: what is due; its inputs have ``kind``, words for what they try
    :param followed: log lines after each input, see :func:`rows`
    :param places: of the inputs that the check is about
    :param part: places on which one mistake may explain all, see ``Specification.cause``
    :param why_missing: explains a warning that did not come, by default by where else it is
    :param shared: see :func:`share`
    """
    came = warnings_after(followed)
    wrong = [place for place in places if (came[place] or 0) != asked.answers[place]]
    if not wrong:
        return
    place = wrong[0]
    due, count = asked.answers[place], came[place] or 0
    short = count < due
    repeats = any((one or 0) > len(asked.row(row)) for row, one in enumerate(came))
    other = MISSED_WARNING if short else REPEATED if repeats else FALSE_ALARM
    elsewhere = why_missing or (lambda one: why_not_logged(run, followed[one] or [], WARN))
    raise Failed(
        expected=f'{lines(due, WARN)} after {_what(asked.row(place))}',
        observed='the run ended before it was sent' if came[place] is None else lines(count, WARN),
        why=why_silent(run)
        or (elsewhere(place) if short else None)
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


def warnings_after(followed: Iterable[Row | None]) -> list[int | None]:
    """Return how many WARN lines came after each input, None where it was not sent."""
    return [row if row is None else sum(line['level'] == WARN for line in row) for row in followed]
