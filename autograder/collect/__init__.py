"""
The command ``collect``: what students handed in elsewhere, laid where nbgrader looks for it.

Each file is written whole or not at all, the source is only read, and everything that was found is
in one table: what was taken, what was not, and why.  Running it again changes nothing.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
import re
import sys
from typing import Any
import unicodedata

from autograder.collect.kinds import Handed, handed_in
from autograder.collect.tree import File, opened, UnreadableError
from autograder.explaining.feedback import printable
from autograder.handed_in.submission import marks_of, read_notebook, read_release
from autograder.layout import Layout
from autograder.runs.recording import keep
from autograder.whole_class.inbox import is_student_id, read_file

TAKEN, REPLACED, UNCHANGED, LEFT = 'taken', 'replaced', 'unchanged', 'not taken'
STAMP = 'timestamp.txt'


@dataclass(frozen=True)
class Row:
    """
    One line of the table.

    :param student: the student id in ``submitted/``, or as the source names them
    :param place: where in the source
    :param done: one of the four words above
    :param notes: what somebody should know about it
    """

    student: str
    assignment: str
    place: str
    done: str
    notes: tuple[str, ...] = ()
    person: str = ''

    def to_json(self) -> dict[str, Any]:
        """Return JSON types only."""
        return asdict(self)


class Course:
    """
    What is known of the assignments.

    :param layout: of the course
    """

    def __init__(self, layout: Layout) -> None:
        """Read nothing yet."""
        self.layout = layout

    @cached_property
    def cells(self) -> Mapping[str, frozenset[str]]:
        """Return the grade ids of every released notebook, by assignment."""
        return {
            name: frozenset(
                marks_of(cell)['grade_id']
                for cell in read_release(self.layout.release(name))['cells']
                if 'grade_id' in marks_of(cell)
            )
            for name in self.layout.assignments()
        }

    def file_name(self, assignment: str) -> str:
        """Return the notebook's file name."""
        return self.layout.release(assignment).name

    def of_file(self, name: str) -> str:
        """Return the assignment whose notebook is called so, browsers' additions aside."""
        plain = re.sub(r'( ?\(\d+\)|-\d+| - Copy)+(?=\.ipynb$)', '', name)
        found = [one for one in self.layout.assignments() if self.file_name(one) in (name, plain)]
        return found[0] if len(found) == 1 else ''

    def of_content(self, data: bytes) -> str:
        """Return the assignment that most cells come from; nothing if it cannot be told."""
        cells, _ = read_notebook(data, '')
        ids = {cell.grade_id for cell in cells or ()} - {''}
        shared = {name: len(ids & theirs) for name, theirs in self.cells.items()}
        best = max(shared, key=lambda name: shared[name], default='')
        return best if best and shared[best] else ''


@dataclass(frozen=True)
class Chosen:
    """A notebook that could be taken."""

    handed: Handed
    student: str
    assignment: str
    data: bytes
    notes: tuple[str, ...]


def collect(
    source: Path,
    layout: Layout,
    to: Path,
    assignment: str = '',
    kind: str = '',
    write: bool = True,
) -> list[Row]:
    """
    Take in a class.

    :param source: a folder or a zip file
    :param to: receives ``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb``
    :param assignment: the only one wanted; empty to go by the notebooks
    :param kind: of the source, empty to find out
    :param write: False to only say what would be done
    :returns: the table
    :raises GraderError: if the source as a whole cannot be used
    """
    course = Course(layout)
    rows: list[Row] = []
    found: list[Chosen] = []
    with opened(source) as tree:
        rows += [Row('', '', place, LEFT, (reason,)) for place, reason in tree.refused]
        for handed in handed_in(tree, kind):
            one = _look(handed, course, assignment)
            if isinstance(one, Row):
                rows.append(one)
            else:
                found.append(one)
        for several in _by_owner(found).values():
            rows += _take(several, course, to, write)
    return sorted(rows, key=lambda row: (row.student, row.assignment, row.place))


def _look(handed: Handed, course: Course, wanted: str) -> Row | Chosen:
    """Find the notebook in what one student handed in."""
    student = student_id(handed.student)
    notes = ['late, as the source says'] if handed.late else []
    if student != handed.student:
        notes.append(f'the name was {handed.student[:60]!r}')

    def leave(why: str) -> Row:
        return Row(student, wanted, handed.place, LEFT, (why, *notes), handed.person)

    if not student:
        return leave('no letter or digit in the name')
    notebooks = [file for file in handed.files if file.name.endswith('.ipynb')]
    if not notebooks:
        there = ', '.join(file.name for file in handed.files[:3]) or 'nothing'
        return leave(f'no notebook, only {there}'[:160])
    file = _best(notebooks, course, wanted or handed.assignment)
    if len(notebooks) > 1:
        notes.append(f'{file.path} of {len(notebooks)} notebooks')
    try:
        data = file.read()
    except UnreadableError as error:
        return leave(f'{file.path}: {error}')
    content = course.of_content(data)
    assignment = wanted or handed.assignment or content or course.of_file(file.name)
    if not assignment or assignment not in course.layout.assignments():
        return leave(f'{file.path}: no assignment of this course; name it with --assignment')
    if content and content != assignment:
        return leave(f'wrong assignment: {file.path} is {content}')
    if file.name != course.file_name(assignment):
        notes.append(f'the file was called {file.name[:60]!r}')
    return Chosen(handed, student, assignment, data, tuple(notes))


def _best(notebooks: Sequence[File], course: Course, assignment: str) -> File:
    """Return the notebook with the assignment's name and folder, else the first."""

    def fit(file: File) -> tuple[bool, bool, int]:
        named = course.of_file(file.name)
        right = bool(named) and (not assignment or named == assignment)
        return (right, bool(assignment) and assignment in file.parts, -len(file.parts))

    return max(notebooks, key=fit)


def _by_owner(found: Sequence[Chosen]) -> dict[tuple[str, str], list[Chosen]]:
    """Return what belongs together, the newest first."""
    owners: dict[tuple[str, str], list[Chosen]] = {}
    for one in found:
        owners.setdefault((one.student, one.assignment), []).append(one)
    for several in owners.values():
        several.sort(
            key=lambda one: (
                one.handed.when.timestamp() if one.handed.when else 0.0,
                one.handed.turn,
                one.handed.place,
            ),
            reverse=True,
        )
    return owners


def _take(several: Sequence[Chosen], course: Course, to: Path, write: bool) -> list[Row]:
    """Lay the newest of several where nbgrader looks, and say so for each of them."""
    newest, *older = several
    rows = []
    names = {one.handed.student for one in several}
    if len(names) > 1:  # two people whose names came out the same: nobody's work is lost unseen
        why = f'the same student id as {", ".join(map(repr, sorted(names)))}'[:160]
        return [_row(one, LEFT, (why, *one.notes)) for one in several]
    notes = newest.notes
    if older:
        notes = (f'the newest of {len(several)}', *notes)
    try:
        done = _lay(newest, course, to, write)
        rows.append(_row(newest, done, notes))
    except OSError as error:
        why = f'cannot be written: {(error.strerror or "error").lower()}'
        rows.append(_row(newest, LEFT, (why, *notes)))
    rows += [_row(one, LEFT, ('an earlier one', *one.notes)) for one in older]
    return rows


def _row(one: Chosen, done: str, notes: tuple[str, ...]) -> Row:
    return Row(
        one.student, one.assignment, one.handed.place, done, notes, person=one.handed.person
    )


def _lay(one: Chosen, course: Course, to: Path, write: bool) -> str:
    """Write a notebook and its time, unless they are there."""
    folder = to / one.student / one.assignment
    wanted = {course.file_name(one.assignment): one.data}
    if one.handed.when:
        wanted[STAMP] = f'{one.handed.when:%Y-%m-%d %H:%M:%S} UTC\n'.encode()
    for part in (folder.parent, folder):
        if part.is_symlink():
            raise NotADirectoryError(20, 'a link where a folder should be')
    there = {name: read_file(folder / name, name)[0] for name in wanted}
    changed = {name: data for name, data in wanted.items() if there[name] != data}
    if not changed:
        return UNCHANGED
    if write:
        for name, data in changed.items():
            keep(folder / name, data)
    return REPLACED if any(data is not None for data in there.values()) else TAKEN


def print_rows(rows: Sequence[Row], to: Path, written: bool) -> None:
    """Print the table and one line about it; names from outside are shown as text."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console(width=None if sys.stdout.isatty() else 140)
    table = Table()
    for title in ('Student', 'Assignment', 'Done', 'From', 'Notes'):
        table.add_column(title, overflow='fold')
    for row in rows:
        student = f'{row.student} ({row.person})' if row.person else row.student
        cells = (student, row.assignment, row.done, row.place, '; '.join(row.notes))
        table.add_row(*(Text(printable(cell)) for cell in cells))
    console.print(table)
    counts = Counter(row.done for row in rows)
    said = (
        ', '.join(f'{count} {done}' for done, count in sorted(counts.items())) or 'nothing there'
    )
    where = f'Folder: {to}' if written else 'Nothing was written (--dry-run)'
    console.print(
        f'{said or "nothing there"}. {where}.', markup=False, highlight=False, soft_wrap=True
    )


def student_id(name: str) -> str:
    """
    Return a name as a student id: what nbgrader and every file system take.

    Letters of all alphabets stay; empty if nothing is left.
    """
    text = unicodedata.normalize('NFC', name).strip()
    text = re.sub(r'[^\w .@-]', '_', text).strip(' ._-')[:100].rstrip()
    return text if is_student_id(text) else ''
