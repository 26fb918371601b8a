"""
Write CSV as in RFC 4180, safe to open in a spreadsheet.

Lines end with CR LF, and all lines have the same number of fields.  Fields with a comma, a quote
or a line break are quoted, and quotes are doubled.

A spreadsheet runs a cell that begins like a formula, and names and causes come from students.  So
such a string gets an apostrophe in front, as OWASP recommends against CSV injection.  Numbers are
written unchanged.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
import csv
import io
import re

from autograder.classroom.results_of_class import ClassResults
from autograder.explaining.feedback import headline, number, printable
from autograder.exports.marks import automatic, Mark
from autograder.results import SubmissionResult

FORMULA_STARTS = ('=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠')
"""First characters of cells that a spreadsheet may run, including full-width signs."""

LATER_CELL = re.compile(r'(?<![;"\s])((?=["\s]*[;\t\r\n])[;"\s]+)([=+\-@＝＋－＠])')
"""Start of a formula after a semicolon, tab or line break, where a spreadsheet may split cells."""

MARKS = [
    'assignment',
    'student',
    'name',
    'status',
    'points',
    'max_points',
    'late_points',
    'first_cause',
    'flags',
]
CHECKS = [
    'assignment',
    'student',
    'status',
    'exam',
    'check',
    'verdict',
    'points',
    'max_points',
    'cause_id',
    'cause',
]

Cell = str | float | None


def marks_csv(
    classes: Iterable[tuple[ClassResults, Sequence[Mark]]], people: Mapping[str, str]
) -> bytes:
    """
    Return one row per student.

    :param classes: results and marks; a student without a submission has only a mark
    :param people: names by student id, as far as they are known
    """
    rows = [
        (
            graded.assignment,
            mark.student,
            people.get(mark.student, ''),
            mark.status,
            mark.points,
            mark.max_points,
            mark.late_points or None,
            headline(result) if result else '',
            '; '.join(result.flags) if result else '',
        )
        for graded, marks in classes
        for result, mark in _with_results(graded, marks)
    ]
    return csv_bytes(MARKS, rows)


def _with_results(
    graded: ClassResults, marks: Sequence[Mark]
) -> Iterator[tuple[SubmissionResult | None, Mark]]:
    """Yield each mark with its result; None for a student without a submission."""
    results = {result.student: result for result in graded.results}
    yield from ((results.get(mark.student), mark) for mark in marks)


def checks_csv(classes: Iterable[ClassResults]) -> bytes:
    """Return a CSV table with one row per submission and check; without a mark, no points."""
    rows = [
        (
            graded.assignment,
            result.student,
            mark.status,
            exam.exam,
            check.check,
            check.verdict.value,
            None if mark.points is None else check.points,
            check.max_points,
            check.cause_id,
            check.cause,
        )
        for graded in classes
        for result, mark in ((one, automatic(one)) for one in graded.results)
        for exam in result.exams
        for check in exam.checks
    ]
    return csv_bytes(CHECKS, rows)


def csv_bytes(header: Sequence[str], rows: Iterable[Sequence[Cell]]) -> bytes:
    """Return a CSV table in UTF-8."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\r\n')
    writer.writerow(header)
    writer.writerows([_field(cell) for cell in row] for row in rows)
    return text.getvalue().encode('utf-8', 'replace')


def _field(cell: Cell) -> str:
    """Return the text of a cell: empty for None, a number unchanged, a string made harmless."""
    if cell is None:
        return ''
    return harmless(cell) if isinstance(cell, str) else number(cell)


def harmless(text: str) -> str:
    """
    Return a string that a spreadsheet reads neither as a formula nor as several cells.

    In languages with a decimal comma, spreadsheets split cells at semicolons, even quoted ones.
    """
    formula = text.lstrip(' ').startswith(FORMULA_STARTS) or text.lstrip().startswith(
        FORMULA_STARTS
    )
    text = LATER_CELL.sub(r"\1'\2", text)
    return f"'{printable(text)}" if formula else printable(text)
