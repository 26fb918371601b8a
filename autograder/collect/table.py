"""Print the table of collected and refused work."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
import sys

from rich.console import Console
from rich.table import Table
from rich.text import Text

from autograder.explaining.feedback import printable

TAKEN, REPLACED, UNCHANGED, LEFT = 'taken', 'replaced', 'unchanged', 'not taken'


@dataclass(frozen=True)
class Row:
    """
    One row of the table.

    :param student: student id, empty if it is not known
    :param place: the entry of the source
    :param done: :data:`TAKEN`, :data:`REPLACED`, :data:`UNCHANGED` or :data:`LEFT`
    :param person: the student's name, if the id is not a name
    :param handed_in: time of delivery in UTC to the minute, empty if it is not known
    """

    student: str
    assignment: str
    place: str
    done: str
    notes: tuple[str, ...] = ()
    person: str = ''
    handed_in: str = ''


def unclaimed(place: str, why: str) -> Row:
    """Return the row of an entry that belongs to no known student."""
    return Row('', '', place, LEFT, (why,))


def print_rows(rows: Sequence[Row], to: Path, written: bool) -> None:
    """Print the table and a summary; control characters in names are replaced."""
    console = Console(width=None if sys.stdout.isatty() else 160)
    table = Table()
    for title in ('Student', 'Assignment', 'Done', 'Handed in', 'From', 'Notes'):
        table.add_column(title, overflow='fold')
    for row in rows:
        student = f'{row.student} ({row.person})' if row.person else row.student
        notes = '; '.join(row.notes)
        cells = (student, row.assignment, row.done, row.handed_in, row.place, notes)
        table.add_row(*(Text(printable(cell)) for cell in cells))
    console.print(table)
    counts = Counter(row.done for row in rows)
    said = ', '.join(f'{count} {done}' for done, count in sorted(counts.items()))
    where = f'Folder: {to}' if written else 'Nothing was written (--dry-run)'
    summary = f'{said or "no submissions"}. {where}. Times are UTC.'
    console.print(summary, markup=False, highlight=False, soft_wrap=True)
