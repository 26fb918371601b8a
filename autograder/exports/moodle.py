"""
Enter the grades in a grading worksheet from Moodle.

Moodle exports and imports this format (``mod/assign/gradingtable.php`` and
``feedback/offline/importgradeslib.php``): a header in the user's language, the column
``Identifier`` first with ``Participant 4711``, the grade, the maximum grade right after it, and
the time of the last change, which Moodle checks.  The names of downloaded submissions contain
the same number, so ``collect`` knows it.  Moodle reads a decimal point in every language.
"""

from collections.abc import Mapping, Sequence
import re

from autograder.classroom.tables import parse_table, Table
from autograder.errors import GraderError
from autograder.exports.filling import add_names, factor_for, Filled, matched, to_number
from autograder.exports.marks import Mark

GRADE = 'Grade'
"""The English header of the grade column."""
PARTICIPANT = re.compile(r'\D*(\d+)')
FIX = (
    'Try: in Moodle turn on "Offline grading worksheet" in the settings of the assignment, then '
    'choose Download grading worksheet'
)


def fill(
    data: bytes,
    where: str,
    marks: Sequence[Mark],
    numbers: Mapping[str, str],
    column: str = GRADE,
    scale: bool = False,
) -> Filled:
    """
    Enter marks in a grading worksheet.

    :param where: name of the file in messages
    :param numbers: participants' numbers by student id, if ``collect`` has seen them; if a
        student has several, from several activities, they are separated by spaces
    :param column: header of the grade column, in the language of the worksheet
    :param scale: whether to convert the points if Moodle has a different maximum
    :raises GraderError: if the data is not a grading worksheet, the column is missing, or the
        maxima differ and ``scale`` is False
    """
    table = _read(data, where)
    index = _grade(table, where, column)
    possible = to_number(table.rows[1][index + 1]) if len(table.header) > index + 1 else None
    factor = factor_for(where, column, possible, marks, scale)
    done = Filled('Moodle', column=column)
    rows = matched(_lines(table, index, marks, numbers), marks, 'participant', done)
    for row, mark in rows.items():
        done.enter(table.rows[row], index, mark, factor)
    done.untouched = len(table.rows) - 1 - len(rows)
    done.data = table.to_bytes()
    return done


def _lines(
    table: Table, index: int, marks: Sequence[Mark], numbers: Mapping[str, str]
) -> dict[str, set[int]]:
    """Return the rows of each student by number or, if the number is unknown, by id."""
    by_number: dict[str, set[int]] = {}
    by_id: dict[str, set[int]] = {}
    for row, cells in enumerate(table.rows[1:], start=1):
        if match := PARTICIPANT.fullmatch(cells[0]):
            by_number.setdefault(match[1], set()).add(row)
        for cell in cells[1:index]:
            add_names(by_id, cell, row)
    # A number belongs to one person; two people may share a name.
    for mark in marks:
        if mark.student in numbers:
            found = (by_number.get(one, set()) for one in numbers[mark.student].split())
            by_id[mark.student] = set().union(*found)
    return by_id


def _read(data: bytes, where: str) -> Table:
    try:
        table = parse_table(data)
        if len(table.rows) < 2 or not all(PARTICIPANT.fullmatch(row[0]) for row in table.rows[1:]):
            raise ValueError('the first column does not contain participant numbers')
    except ValueError as error:
        raise GraderError(
            f'{where}: this is not a grading worksheet from Moodle: {error}.', FIX
        ) from error
    return table


def _grade(table: Table, where: str, column: str) -> int:
    """Return the index of the column with the grades."""
    if table.header.count(column) != 1:
        raise GraderError(
            f'{where}: there is no column {column!r}.',
            f'Try: --column with one of {", ".join(table.header[1:])}',
        )
    return table.header.index(column)
