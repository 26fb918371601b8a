"""
Fill the column of one assignment in a gradebook file exported from Canvas.

The file has the format of Canvas's ``gradebook_exporter.rb`` and ``gradebook_importer.rb``:

* a header with ``Student`` (or ``LastName``, ``FirstName``), ``ID``, optional columns such as
  ``SIS User ID`` and ``SIS Login ID``, ``Section``, custom columns, assignments as ``Name (id)``,
  and totals;
* an optional line of posting policies;
* a line ``Points Possible``, with ``(read only)`` in columns that cannot be changed;
* one line per student.

Fields are separated by commas or, in some languages, by semicolons.  Students are matched by id,
never by name.
"""

from __future__ import annotations

from collections.abc import Sequence
import csv
from dataclasses import dataclass, field
from difflib import get_close_matches
import io
from pathlib import Path
import re

from autograder.errors import GraderError
from autograder.explaining.feedback import number
from autograder.exports.marks import Mark
from autograder.submission.ids import student_id

ID_COLUMNS = ('SIS Login ID', 'SIS User ID', 'ID')
"""Columns that may contain a student's id."""

ASSIGNMENT = re.compile(r'^(?P<title>.*\S) \((?P<id>\d+)\)$')
READ_ONLY = re.compile(r'read\s+only')
KEPT = {'EX': 'is excused in Canvas', 'N/A': 'does not have this assignment in Canvas'}
"""Cell contents that Canvas uses instead of a score; such cells are kept."""
BOM = '\N{ZERO WIDTH NO-BREAK SPACE}'
SHOWN = 12


@dataclass(frozen=True)
class Gradebook:
    """
    A gradebook file from Canvas, cell by cell.

    :param possible: index of the line ``Points Possible``
    :param delimiter: comma or semicolon
    :param newline: line ending
    :param bom: whether the file begins with a byte order mark
    """

    rows: list[list[str]]
    possible: int
    delimiter: str
    newline: str
    bom: bool

    @property
    def header(self) -> list[str]:
        """Return the names of the columns."""
        return self.rows[0]

    def students(self) -> range:
        """Return the indices of the students' lines."""
        return range(self.possible + 1, len(self.rows))

    def to_bytes(self) -> bytes:
        """Return the content of the file, in UTF-8."""
        text = io.StringIO()
        writer = csv.writer(text, delimiter=self.delimiter, lineterminator=self.newline)
        writer.writerows(self.rows)
        return ((BOM if self.bom else '') + text.getvalue()).encode('utf-8')


@dataclass
class Filled:
    """
    A gradebook file with entered marks, and the changes to it.

    :param data: the new content of the file
    :param column: header of the column
    :param filled: number of entered scores
    :param replaced: student, old content and new content of a cell
    :param left_out: student, and why no score was entered
    :param untouched: number of students in the file without a submission
    """

    data: bytes = b''
    column: str = ''
    filled: int = 0
    replaced: list[tuple[str, str, str]] = field(default_factory=list)
    left_out: list[tuple[str, str]] = field(default_factory=list)
    untouched: int = 0

    def text(self) -> str:
        """Return the changes as text, one line each."""
        lines = [f'{self.column}: {self.filled} scores entered.']
        lines += [f'replaced: {who}: {old} -> {new}' for who, old, new in self.replaced]
        lines += [f'not entered: {who}: {why}' for who, why in self.left_out]
        if self.untouched:
            lines.append(f'{self.untouched} rows have no submission and are unchanged.')
        return '\n'.join(lines)


def fill(data: bytes, where: str, column: str, marks: Sequence[Mark], scale: bool) -> Filled:
    """
    Enter marks in one column of a Canvas gradebook.

    :param data: content of the file from Canvas
    :param where: name of the file in messages
    :param column: header, title or id of the column
    :param scale: whether to convert the points if Canvas has a different maximum
    :raises GraderError: if the data is not a Canvas gradebook, the column is missing, or the
        maxima differ and ``scale`` is False
    """
    book = read(data, where)
    index = _column(book, where, column)
    factor = _factor(book, where, index, marks, scale)
    done = Filled(column=book.header[index])
    rows = _matched(book, marks, done)
    for row, mark in rows.items():
        _enter(book.rows[row], index, mark, factor, done)
    done.untouched = len(book.students()) - len(rows)
    done.data = book.to_bytes()
    return done


def read(data: bytes, where: str) -> Gradebook:
    """
    Read a gradebook file from Canvas.

    :param where: name of the file in messages
    :raises GraderError: if the data is not a Canvas gradebook
    """
    try:
        text = data.decode('utf-8')
    except UnicodeDecodeError as error:
        raise _no_gradebook(where, 'the text is not UTF-8') from error
    bom, text = text.startswith(BOM), text.removeprefix(BOM)
    first = text.partition('\n')[0]
    delimiter = ';' if first.count(';') > first.count(',') else ','
    try:
        rows = list(csv.reader(io.StringIO(text, newline=''), delimiter=delimiter, strict=True))
    except csv.Error as error:
        raise _no_gradebook(where, f'a line is not valid CSV ({error})') from error
    rows = [row for row in rows if row]
    header = rows[0] if rows else []
    if not header or header[0] not in ('Student', 'LastName') or 'ID' not in header:
        raise _no_gradebook(where, f'a first line {",".join(header)[:60]!r}')
    for line, row in enumerate(rows, start=1):
        if len(row) != len(header):
            raise _no_gradebook(
                where, f'line {line} has {len(row)} fields, the first line {len(header)}'
            )
    possible = [index for index, row in enumerate(rows) if 'Points Possible' in row[0]]
    if not possible:
        raise _no_gradebook(where, 'no line "Points Possible"')
    return Gradebook(rows, possible[0], delimiter, '\r\n' if '\r\n' in text else '\n', bom)


def read_file(path: Path) -> bytes:
    """
    Return the content of a gradebook file from Canvas.

    :raises GraderError: if the file cannot be read
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise GraderError(
            f'{path}: the gradebook from Canvas cannot be read: {error.strerror}.',
            'Try: in Canvas choose Grades, Export, Export Entire Gradebook',
        ) from error


def _no_gradebook(where: str, got: str) -> GraderError:
    return GraderError(
        f'{where}: this is not a gradebook exported from Canvas: {got}.',
        'Try: in Canvas choose Grades, Export, Export Entire Gradebook; do not save the file '
        'with Excel',
    )


def _column(book: Gradebook, where: str, wanted: str) -> int:
    """Return the index of the assignment column with this header, title or id."""
    there = {
        index: found
        for index, name in enumerate(book.header)
        if (found := ASSIGNMENT.match(name))
        and not READ_ONLY.search(book.rows[book.possible][index])
    }
    exact = [index for index, found in there.items() if found[0] == wanted]
    meant = exact or [
        index for index, found in there.items() if wanted in (found['title'], found['id'])
    ]
    if len(meant) == 1:
        return meant[0]
    names = [found[0] for found in there.values()]
    if meant:
        several = ', '.join(book.header[index] for index in meant)
        raise GraderError(
            f'{where}: several columns match {wanted!r}: {several}.', 'Try: --column with an id'
        )
    titles = {found['title']: found[0] for found in there.values()}
    close = get_close_matches(wanted, titles, n=1, cutoff=0.5)
    hint = f'Did you mean {titles[close[0]]!r}? ' if close else ''
    raise GraderError(
        f'{where}: there is no assignment column {wanted!r} that can be changed.',
        f'{hint}Columns: {"; ".join(names[:SHOWN]) or "none"}.',
    )


def _factor(book: Gradebook, where: str, index: int, marks: Sequence[Mark], scale: bool) -> float:
    """Return the factor by which points are multiplied; it is 1 if ``scale`` is False."""
    most = max((mark.max_points for mark in marks), default=0.0)
    possible = _number(book.rows[book.possible][index])
    if possible is None or most <= 0 or abs(possible - most) < 0.005:
        return 1.0
    if possible <= 0:
        raise GraderError(
            f'{where}: expected {number(most)} points possible for {book.header[index]}, got '
            f'{number(possible)}: scaled to that, everybody would have nothing.',
            f'Try: set the points of the assignment in Canvas to {number(most)}, and export again',
        )
    if scale:
        return possible / most
    raise GraderError(
        f'{where}: expected {number(most)} points possible for {book.header[index]}, got '
        f'{number(possible)}.',
        f'Try: change the points of the assignment in Canvas, or --scale to multiply by '
        f'{number(possible / most)}',
    )


def _number(text: str) -> float | None:
    """Parse a number with a decimal point or comma, as Canvas writes it; None if it is invalid."""
    parts = re.split('[.,]', text.strip())
    joined = f'{"".join(parts[:-1])}.{parts[-1]}' if len(parts) > 1 else parts[0]
    try:
        return float(joined)
    except ValueError:
        return None


def _matched(book: Gradebook, marks: Sequence[Mark], done: Filled) -> dict[int, Mark]:
    """Return each student's mark by line; leave out students with no line or with several."""
    columns = [book.header.index(name) for name in ID_COLUMNS if name in book.header]
    lines: dict[str, set[int]] = {}
    for row in book.students():
        for column in columns:
            text = book.rows[row][column].strip()
            # The command collect changes names that nbgrader does not accept as ids, such as
            # ann+x@example.org.
            for name in {text, student_id(text)} - {''}:
                lines.setdefault(name, set()).add(row)
    found: dict[int, list[Mark]] = {}
    for mark in marks:
        rows = lines.get(mark.student, set())
        if len(rows) == 1:
            found.setdefault(min(rows), []).append(mark)
            continue
        where = ' and '.join(str(row + 1) for row in sorted(rows))
        names = ', '.join(book.header[column] for column in columns)
        why = f'lines {where} both have this id' if rows else f'no such {names} in the file'
        done.left_out.append((mark.student, why))
    for row, several in found.items():
        if len(several) > 1:
            names = ' and '.join(mark.student for mark in several)
            why = f'{names} match the same row of Canvas, line {row + 1}'
            done.left_out += [(mark.student, why) for mark in several]
    return {row: several[0] for row, several in found.items() if len(several) == 1}


def _enter(row: list[str], index: int, mark: Mark, factor: float, done: Filled) -> None:
    """Write one cell, unless there is no mark or Canvas allows no score for the student."""
    old = row[index].strip()
    if mark.points is None:
        kept = f'; Canvas keeps {old}' if old else ''
        done.left_out.append((mark.student, f'{mark.status}{kept}'))
        return
    if old.upper() in KEPT:
        done.left_out.append((mark.student, KEPT[old.upper()]))
        return
    new = number(mark.points * factor)
    if old and _number(old) != _number(new):
        done.replaced.append((mark.student, old, new))
    row[index] = new
    done.filled += 1
