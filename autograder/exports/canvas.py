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
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
import re

from autograder.classroom.tables import parse_table, read_bytes, Table
from autograder.errors import GraderError
from autograder.exports.filling import add_names, factor_for, Filled, matched, to_number
from autograder.exports.marks import Mark

ID_COLUMNS = ('SIS Login ID', 'SIS User ID', 'ID')
"""Columns that may contain a student's id."""

ASSIGNMENT = re.compile(r'^(?P<title>.*\S) \((?P<id>\d+)\)$')
READ_ONLY = re.compile(r'read\s+only')
KEPT = {'EX': 'is excused in Canvas', 'N/A': 'does not have this assignment in Canvas'}
"""Cells that say why there is no score; they are kept."""
SHOWN = 12


@dataclass(frozen=True)
class Gradebook:
    """
    A gradebook file from Canvas.

    :param possible: index of the line ``Points Possible``
    """

    table: Table
    possible: int

    @property
    def rows(self) -> list[list[str]]:
        """Return all lines, the header first."""
        return self.table.rows

    @property
    def header(self) -> list[str]:
        """Return the names of the columns."""
        return self.table.header

    def students(self) -> range:
        """Return the indices of the students' lines."""
        return range(self.possible + 1, len(self.rows))


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
    possible = to_number(book.rows[book.possible][index])
    factor = factor_for(where, book.header[index], possible, marks, scale)
    done = Filled('Canvas', column=book.header[index], kept=KEPT)
    columns = [book.header.index(name) for name in ID_COLUMNS if name in book.header]
    lines: dict[str, set[int]] = {}
    for row in book.students():
        for place in columns:
            add_names(lines, book.rows[row][place], row)
    rows = matched(lines, marks, ', '.join(book.header[one] for one in columns), done)
    for found, mark in rows.items():
        done.enter(book.rows[found], index, mark, factor)
    done.untouched = len(book.students()) - len(rows)
    done.data = book.table.to_bytes()
    return done


def read(data: bytes, where: str) -> Gradebook:
    """
    Read a gradebook file from Canvas.

    :param where: name of the file in messages
    :raises GraderError: if the data is not a Canvas gradebook
    """
    try:
        table = parse_table(data)
    except ValueError as error:
        raise _no_gradebook(where, str(error)) from error
    rows, header = table.rows, table.header
    if not header or header[0] not in ('Student', 'LastName') or 'ID' not in header:
        raise _no_gradebook(where, f'a first line {",".join(header)[:60]!r}')
    possible = [index for index, row in enumerate(rows) if 'Points Possible' in row[0]]
    if not possible:
        raise _no_gradebook(where, 'no line "Points Possible"')
    return Gradebook(table, possible[0])


def read_file(path: Path) -> bytes:
    """
    Return the content of a gradebook file from Canvas.

    :raises GraderError: if the file cannot be read
    """
    fix = 'Try: in Canvas choose Grades, Export, Export Entire Gradebook'
    return read_bytes(path, 'the gradebook from Canvas', fix)


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
