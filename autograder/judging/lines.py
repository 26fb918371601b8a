"""
Judge the log lines that follow inputs: their number, and whether they show the input.

The lines that follow an input, or a burst of inputs, are a row, see
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
    One input or a burst, and the log lines that followed.

    :param inputs: one input, or all of a burst; each has a method ``is_in``, which returns whether
        a text shows the input
    :param row: None if the run ended before all of the inputs were sent
    """

    inputs: Sequence[Any]
    row: Row | None

    @property
    def logs(self) -> Row:
        """Return the lines that followed, empty if the inputs were not sent."""
        return self.row or []

    def count(self, level: int) -> int:
        """Return the number of lines at a level."""
        return sum(entry['level'] == level for entry in self.logs)

    def showing(self, one: Any, level: int = INFO) -> int:
        """Return the number of lines at a level that show an input."""
        return sum(one.is_in(entry['text']) for entry in self.logs if entry['level'] == level)


def followed(run: Run, ask: str) -> list[Followed]:
    """Return every input or burst of a specification, sent or not, with the log lines after it."""
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
    Fail unless inputs are followed by the expected number of WARN lines.

    :param asked: specification with the expected counts; its inputs have a ``kind``, their
        description in feedback
    :param followed: log lines after each input, see :func:`rows`
    :param places: indices of the inputs to check
    :param part: indices for which one slip may explain all answers, see ``Specification.cause``
    :param why_missing: explains a missing warning, given its index; by default, searches for the
        line in other places
    :param shared: whether to give a part of the points, see :func:`share`
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
    Return the fraction of the points for correct results before the program ended during the run.

    It is 0 if the run was complete, and at the CPU limit, because how far a program gets before
    this limit depends on the machine.
    """
    if None not in followed or run.recording.end_reason == 'cpu_limit' or not due:
        return 0.0
    return round(right / due, 2)


def _what(inputs: Sequence[Any]) -> str:
    return f'a burst of {len(inputs)} readings' if len(inputs) > 1 else str(inputs[0].kind)


def warnings_after(followed: Iterable[Row | None]) -> list[int | None]:
    """Return the number of WARN lines after each input, None if the input was not sent."""
    return [row if row is None else sum(line['level'] == WARN for line in row) for row in followed]
