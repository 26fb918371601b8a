"""
Compare the log lines that follow each input of a run with the expected warnings.

As in :mod:`.rows`, the lines after one input, or after a burst, form a row.
"""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from autograder.exam.exam import Cause, Failed, Run
from autograder.exam.patterns import why_pattern
from autograder.exam.slips import REPEATED, WHY
from autograder.exam.specification import Specification
from autograder.judging.causes.ended import while_running, why_silent
from autograder.judging.causes.missing_logs import lines_of_code, why_left_out, why_not_logged
from autograder.judging.causes.text_table import acts_by_cause, cause_of
from autograder.judging.checks import lines, own_logs
from autograder.judging.numbers import numbers_in
from autograder.judging.rows import LATE_S, Row, rows, without_last
from autograder.recording import INFO, SECOND, WARN


@dataclass(frozen=True)
class Followed:
    """
    One input or a burst, and the log lines that followed.

    :param inputs: one input, or all inputs of a burst; each has a method ``is_in``, which returns
        whether a text shows the input
    :param row: None if the run ended before all inputs were sent
    """

    inputs: Sequence[Any]
    row: Row | None

    @property
    def logs(self) -> Row:
        """Return the lines that followed, empty if the inputs were not sent."""
        return self.row or []

    def texts(self, level: int) -> list[str]:
        """Return the lines at a level."""
        return [entry['text'] for entry in self.logs if entry['level'] == level]

    def count(self, level: int) -> int:
        """Return the number of lines at a level."""
        return len(self.texts(level))

    def numbers(self, level: int) -> list[float]:
        """Return the numbers in the lines at a level."""
        return [number for text in self.texts(level) for number in numbers_in(text)]

    def showing(self, one: Any) -> int:
        """Return the number of INFO lines that show an input."""
        return sum(map(one.is_in, self.texts(INFO)))


def followed(run: Run, ask: str, logger: str) -> list[Followed]:
    """Return every input or burst of a specification, sent or not, with the log lines after it."""
    found = rows(run, ask, own_logs(run, logger))
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

    :param asked: specification with the expected counts; each input has a ``kind``, its
        description in feedback
    :param followed: log lines after each input, see :func:`rows`
    :param places: indices of the inputs to check
    :param part: indices for which one slip may explain all answers, see ``Specification.cause``
    :param why_missing: explains a missing warning, given its index; by default, searches for the
        line in other places
    :param shared: whether to give partial points, see :func:`share`
    """
    came = warnings_after(followed)
    wrong = [place for place in places if (came[place] or 0) != asked.answers[place]]
    if not wrong:
        return
    place = wrong[0]
    due, count = asked.answers[place], came[place] or 0
    short = count < due
    repeats = any((one or 0) > len(asked.row(row)) for row, one in enumerate(came))
    right = (followed[one] for one in range(len(came)) if came[one] == asked.answers[one])
    late = _warns_later(run, followed[place]) and not any(_warns_later(run, row) for row in right)
    needless = cause_of('warns_later') if late else REPEATED if repeats else WHY['false_alarm']
    other = WHY['missed_warning'] if short else needless
    row, inputs = followed[place] or [], asked.row(place)
    then, known = while_running(run, asked, place, short), without_last(run, came, place)
    slip = asked.cause(known, place, part)
    what = f'a burst of {len(inputs)} readings' if len(inputs) > 1 else inputs[0].kind
    raise Failed(
        expected=f'{lines(due, WARN)} after {what}',
        observed='the run ended before this input' if came[place] is None else lines(count, WARN),
        why=why_silent(then)
        or (why_missing(place) if why_missing and short else None)
        or (why_left_out(run, WARN, warn_lines(followed)) if short else None)
        or (slip if any(came) else None)
        or (why_not_logged(then, row, WARN) if short and not count and not why_missing else None)
        or slip
        or why_pattern(asked.answers, known, 'warns about', 'high value')
        or _why_from_elsewhere(came, asked.answers, followed, place)
        or other,
        blocks=not any(came),  # if the node warns at all, judge the other checks too
        share=share(run, followed, len(places) - len(wrong), len(places)) if shared else 0.0,
        act=acts_by_cause()['false_alarm'],
        # If an input was not sent, the indices of the recording differ.
        place=None if None in came[:place] else place,
    )


def _warns_later(run: Run, row: Row | None) -> bool:
    """Return whether a WARN line comes some time after the last input before it."""
    sent = [one['clock_ns'] for one in run.recording.of('input')]
    delays_ns = [line['clock_ns'] - sent[line['after_input']] for line in warn_lines([row])]
    return max(delays_ns, default=0) > LATE_S * SECOND


def _why_from_elsewhere(
    came: Sequence[int | None], due: Sequence[int], followed: Sequence[Row | None], place: int
) -> Cause | None:
    """Explain a needless WARN line whose line of code never logs a correct warning."""
    exact = [row for row, count, wanted in zip(followed, came, due) if count == wanted]
    right = lines_of_code(warn_lines(exact))
    others = sorted(lines_of_code(warn_lines([followed[place]])) - right)
    return cause_of('other_warning', line=others[0]) if right and others else None


def warn_lines(followed: Iterable[Row | None]) -> Row:
    """Return the WARN lines of all rows."""
    return [line for row in followed for line in row or () if line['level'] == WARN]


def share(run: Run, followed: Sequence[Row | None], right: int, due: int) -> float:
    """
    Return the fraction of the points for the correct results of a program that ended early.

    The fraction is 0 if the run was complete, or if the CPU limit ended it: how far a program gets
    before this limit depends on the machine.
    """
    if None not in followed or run.recording.end_reason == 'cpu_limit' or not due:
        return 0.0
    return round(right / due, 2)


def warnings_after(followed: Iterable[Row | None]) -> list[int | None]:
    """Return the number of WARN lines after each input, None if the input was not sent."""
    return [row if row is None else len(warn_lines([row])) for row in followed]
