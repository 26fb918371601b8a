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

from collections.abc import Sequence
from difflib import get_close_matches
import re

from autograder.classroom.tables import parse_table, Table
from autograder.errors import GraderError
from autograder.exports.filling import add_names, factor_for, Filled, matched, to_number
from autograder.exports.marks import Mark

ID_COLUMNS = ('SIS Login ID', 'SIS User ID', 'ID')
"""Columns that may contain a student's id."""

ASSIGNMENT = re.compile(r'^(?P<title>.*\S) \((?P<id>\d+)\)$')
READ_ONLY = re.compile(r'read\s+only')
KEPT = {'EX': 'is excused in Canvas', 'N/A': 'does not have this assignment in Canvas'}
"""Cell values that say why there is no score; such cells are kept."""
SHOWN = 12
FIX = 'Try: in Canvas choose Grades, Export, Export Entire Gradebook'


def fill(data: bytes, where: str, column: str, marks: Sequence[Mark], scale: bool) -> Filled:
    """
    Enter marks in one column of a Canvas gradebook.

    :param where: name of the file in messages
    :param column: header, title or id of the column
    :param scale: whether to convert the points if Canvas has a different maximum
    :raises GraderError: if the data is not a Canvas gradebook, the column is missing, or the
        maxima differ and ``scale`` is False
    """
    table, top = _read(data, where)
    header, students = table.header, range(top + 1, len(table.rows))
    index = _column(table, top, where, column)
    possible = to_number(table.rows[top][index])
    factor = factor_for(where, header[index], possible, marks, scale)
    done = Filled('Canvas', column=header[index], kept=KEPT)
    columns = [header.index(name) for name in ID_COLUMNS if name in header]
    lines: dict[str, set[int]] = {}
    for row in students:
        for place in columns:
            add_names(lines, table.rows[row][place], row)
    rows = matched(lines, marks, ', '.join(header[one] for one in columns), done)
    for row, mark in rows.items():
        done.enter(table.rows[row], index, mark, factor)
    done.untouched = len(students) - len(rows)
    done.data = table.to_bytes()
    return done


def _read(data: bytes, where: str) -> tuple[Table, int]:
    """Return a gradebook file from Canvas, and the index of its row ``Points Possible``."""
    try:
        table = parse_table(data)
        header = table.header
        if not header or header[0] not in ('Student', 'LastName') or 'ID' not in header:
            raise ValueError(f'the first line is {",".join(header)[:60]!r}')
        possible = [row for row, cells in enumerate(table.rows) if 'Points Possible' in cells[0]]
        if not possible:
            raise ValueError('there is no line "Points Possible"')
    except ValueError as error:
        raise GraderError(
            f'{where}: this is not a gradebook exported from Canvas: {error}.',
            f'{FIX}; do not save the file with Excel',
        ) from error
    return table, possible[0]


def _column(table: Table, top: int, where: str, wanted: str) -> int:
    """Return the index of the assignment column with this header, title or id."""
    there = {
        name: found
        for name, points in zip(table.header, table.rows[top])
        if (found := ASSIGNMENT.match(name)) and not READ_ONLY.search(points)
    }
    fitting = [name for name, found in there.items() if wanted in (found['title'], found['id'])]
    meant = [wanted] if wanted in there else fitting
    if len(meant) == 1:
        return table.header.index(meant[0])
    if meant:
        raise GraderError(
            f'{where}: several columns match {wanted!r}: {", ".join(meant)}.',
            'Try: --column with an id',
        )
    titles = {found['title']: name for name, found in there.items()}
    close = get_close_matches(wanted, titles, n=1, cutoff=0.5)
    hint = f'Did you mean {titles[close[0]]!r}? ' if close else ''
    raise GraderError(
        f'{where}: there is no assignment column {wanted!r} that can be changed.',
        f'{hint}Columns: {"; ".join([*there][:SHOWN]) or "none"}.',
    )
