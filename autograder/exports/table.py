"""
Write CSV as in RFC 4180, safe to open in a spreadsheet.

Lines end with CR LF, and all lines have the same number of fields.  Fields with a comma, a quote
or a line break are quoted, and quotes are doubled.

A spreadsheet runs a cell that begins like a formula, and names and causes come from students.  So
such a string gets an apostrophe in front, as OWASP recommends against CSV injection.  Numbers are
written unchanged.
"""

from collections.abc import Iterable, Mapping, Sequence
import re

from autograder.classroom.tables import Table
from autograder.explaining.feedback import headline, number, printable
from autograder.exports.marks import Mark

FORMULA_STARTS = ('=', '+', '-', '@', '\t', '\r', '\n', '＝', '＋', '－', '＠')
"""First characters of cells that a spreadsheet may run, including full-width signs."""

LATER_CELL = re.compile(r'(?<![;"\s])((?=["\s]*[;\t\r\n])[;"\s]+)([=+\-@＝＋－＠])')
"""Start of a formula after a semicolon, tab or line break, where a spreadsheet may split cells."""

MARKS = (
    *('assignment', 'student', 'name', 'status', 'points', 'max_points', 'late_points'),
    *('first_cause', 'flags'),
)
CHECKS = (
    *('assignment', 'student', 'status', 'exam', 'check', 'verdict', 'points', 'max_points'),
    *('cause_id', 'cause'),
)

Cell = str | float | None


def marks_csv(marks: Iterable[Mark], people: Mapping[str, str]) -> bytes:
    """Return a CSV table with one row per student; ``people`` maps student ids to names."""
    rows = [
        (
            mark.assignment,
            mark.student,
            people.get(mark.student, ''),
            mark.status,
            mark.points,
            mark.max_points,
            mark.late_points or None,
            headline(mark.result) if mark.result else '',
            '; '.join(mark.result.flags) if mark.result else '',
        )
        for mark in marks
    ]
    return csv_bytes(MARKS, rows)


def checks_csv(marks: Iterable[Mark]) -> bytes:
    """Return a CSV table with one row per submission and check; no points without a mark."""
    rows = [
        (
            mark.assignment,
            mark.student,
            mark.status,
            exam.exam,
            check.check,
            check.verdict.value,
            None if mark.points is None else check.points,
            check.max_points,
            check.cause_id,
            check.cause,
        )
        for mark in marks
        for exam in (mark.result.exams if mark.result else ())
        for check in exam.checks
    ]
    return csv_bytes(CHECKS, rows)


def csv_bytes(header: Sequence[str], rows: Iterable[Sequence[Cell]]) -> bytes:
    """Return a CSV table in UTF-8."""
    cells = [list(header), *([_field(cell) for cell in row] for row in rows)]
    return Table(cells, newline='\r\n').to_bytes()


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
    starts = text.lstrip(' '), text.lstrip()
    formula = any(start.startswith(FORMULA_STARTS) for start in starts)
    text = LATER_CELL.sub(r"\1'\2", text)
    return f"'{printable(text)}" if formula else printable(text)
