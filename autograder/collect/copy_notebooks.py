"""
Collect a class's work: read a source, copy the selected notebooks, and print a table.

Each file is written atomically.  Collecting Monday's zip after Tuesday's changes nothing: if the
times or Canvas's numbers of both notebooks are known, an older notebook does not replace a newer
copy.  Otherwise, as with Moodle and repositories, the new notebook replaces the copy, and a note
in the table reports this.  The replaced notebook is kept in a folder that nbgrader, the grader and
``collect`` ignore, but that ``forget`` moves away with the rest.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
import os
from pathlib import Path
import sys

from rich.console import Console
from rich.table import Table
from rich.text import Text

from autograder.classroom.collected import read_collected, save_collected, Work
from autograder.classroom.people import extensions
from autograder.collect import deliveries
from autograder.collect.course import Course
from autograder.collect.deliveries import LEFT, REPLACED, Row, TAKEN, UNCHANGED, unclaimed
from autograder.collect.owners import check_names, check_owners
from autograder.collect.platforms import EXCHANGE, read_time
from autograder.collect.recognise import find_deliveries, FOLDER
from autograder.collect.selection import choose, Chosen, most_common_assignment, read_notebooks
from autograder.explaining.feedback import printable
from autograder.files import write_atomically
from autograder.layout import Layout
from autograder.submission.inbox import SECRET, STAMP
from autograder.submission.reading import opened, read_file, Tree, UnreadableError

KEPT = '.ipynb_checkpoints'
"""Folder next to a notebook for the notebook that it replaced; all programs ignore it."""


def collect(
    source: Path,
    layout: Layout,
    to: Path,
    assignment: str = '',
    kind: str = '',
    write: bool = True,
    prefix: str = '',
    trust_names: bool = False,
) -> list[Row]:
    """
    Collect the work of a class, and return the table.

    :param source: a folder or a zip file
    :param to: folder that receives ``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb``
    :param assignment: the only assignment to collect; empty to recognise it from the notebooks
    :param kind: platform of the source; empty to recognise it
    :param write: False to only report what would be done
    :param prefix: the prefix to remove from the names of students' folders
    :param trust_names: whether to collect deliveries of an exchange that other users own, and
        those of a second activity in Moodle
    :raises GraderError: if the source as a whole cannot be used, or ``extensions.csv`` or the file
        of saved work is wrong
    """
    course = Course(layout)
    extensions(layout)  # Report a wrong file before anything is copied.
    with opened(source, deliveries.BOUNDS) as tree:
        kind, found, unknown = find_deliveries(tree, course, kind, prefix)
        if kind == EXCHANGE and assignment:
            found = [one for one in found if one.assignment == assignment]
        if kind == EXCHANGE and not trust_names:
            check_owners(found, layout)
        notebooks = {one: read_notebooks(one, course, assignment) for one in found}
        single = kind not in (FOLDER, EXCHANGE)  # Platforms export one assignment at a time.
        if single and not assignment:
            assignment = most_common_assignment(notebooks.values(), course, tree.name)
            for one in found:
                one.assignment = assignment
        before, home = read_collected(layout), to.resolve() == layout.submitted.resolve()
        turns = {(one.student, one.assignment): one.turn for one in before}
        shared = check_names(found, before, trust_names)
        chosen, others = choose(notebooks, course, single)
        placed = _with_turns(chosen, turns if home else {})
        done = [(one, _take(one, course, to, write)) for one in placed]
        rows = [*_refused(tree), *unknown, *others, *(row for _, row in done)]
    if any(one.when for one in chosen) and course.due.problem:
        rows.append(unclaimed('the gradebook', course.due.problem))
    if write:
        works = [*(Work(student, shared=True) for student in shared), *_collected(done, kind)]
        if home:
            works += _not_collected(rows, layout)
        else:  # The saved turns are those of the notebooks in submitted/.
            works = [
                replace(one, turn=turns.get((one.student, one.assignment), '')) for one in works
            ]
        try:
            save_collected(layout, works)
        except OSError as error:
            said = f'names, numbers from Moodle and missing work {_unwritable(error)}'
            rows.append(unclaimed(str(layout.collected), said))
    return sorted(rows, key=lambda row: (row.student, row.assignment, row.place))


def _with_turns(
    chosen: Iterable[Chosen], turns: Mapping[tuple[str, str], str]
) -> Iterator[Chosen]:
    """Yield the selected notebooks, each with the turn of the copy that it would replace."""
    for one in chosen:
        turn = turns.get((one.row.student, one.row.assignment), '')
        yield one._replace(turn_there=int(turn) if turn.isdecimal() else 0)


def _unwritable(error: OSError) -> str:
    return f'cannot be written: {(error.strerror or "error").lower()}'


def _collected(done: Sequence[tuple[Chosen, Row]], kind: str) -> Iterator[Work]:
    """Yield the collected work, for names and exports."""
    for one, row in done:
        if row.done != LEFT:
            number, turn = one.notebook.delivery.number, one.notebook.turn
            turn = max(turn, one.turn_there) if row.done == UNCHANGED else turn
            work = Work(row.student, row.assignment, row.person, kind, row.place, number)
            yield replace(work, turn=str(turn or ''))


def _not_collected(rows: Sequence[Row], layout: Layout) -> Iterator[Work]:
    """Yield the work of known students that was not collected, for the reports."""
    known = layout.assignments()
    for row in rows:
        if row.done == LEFT and row.student:
            what = row.assignment if row.assignment in known else ''
            why, when = row.notes[0], row.handed_in
            yield Work(row.student, what, row.person, why=why, handed_in=when)


def _refused(tree: Tree) -> Iterator[Row]:
    """Yield rows about files that were not read, one per folder and reason."""
    paths = [where.split('/') for where, _ in tree.refused]
    tops = {file.parts[0] for file in tree.files} | {parts[0] for parts in paths}
    depth = 2 if len(tops) == 1 else 1  # A single outer folder contains all students.
    grouped: dict[tuple[str, ...], list[str]] = {}
    for where, why in tree.refused:
        grouped.setdefault((*where.split('/')[:depth], why), []).append(where)
    for (*_, why), places in grouped.items():
        more = (f'and {len(places) - 1} more in the same folder',) if len(places) > 1 else ()
        yield Row('', '', places[0], LEFT, (why, *more))


def _take(one: Chosen, course: Course, to: Path, write: bool) -> Row:
    """Copy a notebook to nbgrader's folder, and return its row."""
    try:
        done, said = write_copy(one, course.file_names[one.row.assignment], to, write)
        if write and done in (TAKEN, REPLACED):
            _copy_secret(one, to)
    except OSError as error:
        done, said = LEFT, _unwritable(error)
    except UnreadableError as error:
        done, said = LEFT, str(error)
    return replace(one.row, done=done, notes=(*filter(None, (said,)), *one.row.notes))


def _copy_secret(one: Chosen, to: Path) -> None:
    """Copy the file from which nbgrader derives the name of the feedback in the exchange."""
    for delivered in one.notebook.delivery.files:
        if delivered.file.path == SECRET:
            path = to / one.row.student / one.row.assignment / SECRET
            write_atomically(path, delivered.file.read())


def write_copy(one: Chosen, file_name: str, to: Path, write: bool) -> tuple[str, str]:
    """
    Write a notebook and its time of delivery, unless an equal or newer copy exists.

    :param write: False to only report what would be done
    :returns: the value of ``Row.done``, and a note for the table
    :raises OSError: if the copy cannot be written
    :raises UnreadableError: if the notebook in the source can no longer be read
    """
    folder = to / one.row.student / one.row.assignment
    kept = folder / KEPT / f'{file_name.removesuffix(".ipynb")}-replaced.ipynb'
    for part in (folder.parent, folder, kept.parent):
        if part.is_symlink():
            raise NotADirectoryError(20, 'a link where a folder should be')
    notebook, time = folder / file_name, folder / STAMP
    wanted = f'{one.when:%Y-%m-%d %H:%M:%S} UTC\n'.encode() if one.when else None
    there, _ = read_file(notebook, file_name)
    time_there, _ = read_file(time, STAMP)
    data = one.notebook.file.read()
    same = there == data
    if same and wanted in (None, time_there):
        return UNCHANGED, ''
    new, old = read_time(wanted)[0], read_time(time_there)[0]
    if there is not None and (why := _why_older(one, new, old)):
        return (UNCHANGED, 'handed in again later') if same else (LEFT, why)
    if write:
        if there is not None and not same:
            write_atomically(kept, there)
        if wanted is None and os.path.lexists(time):
            # Remove the time first: if the process is killed between the two steps, the new
            # notebook must not keep the old time.
            time.unlink()
        if wanted is not None and wanted != time_there:
            write_atomically(time, wanted)
        if not same:
            write_atomically(notebook, data)
    if there is None:
        return TAKEN if time_there is None else REPLACED, ''
    notes = []
    if not (same or (new and old) or (one.notebook.turn and one.turn_there)):
        notes.append(f'it is unknown which notebook is newer; the other one is now in {KEPT}/')
    if old and not wanted:
        notes.append(f'the time of the replaced notebook, {old:%Y-%m-%d %H:%M}, was removed')
    return REPLACED, '; '.join(notes)


def _why_older(one: Chosen, new: datetime | None, old: datetime | None) -> str:
    """Return why a notebook is older than its copy; empty if it is not, or if it is unknown."""
    turn, turn_there = one.notebook.turn, one.turn_there
    if new and old:
        return f'older than the collected one from {old:%Y-%m-%d %H:%M}' if new < old else ''
    if not 0 < turn < turn_there:
        return ''
    said = f'number {turn} in Canvas, older than the collected one, which has {turn_there}'
    return f'{said}. Try: to collect it anyway, delete the collected one'


def print_rows(rows: Sequence[Row], to: Path, written: bool, every: bool = False) -> None:
    """
    Print a table and a summary; control characters in names are replaced.

    :param every: whether the table also lists unchanged work, and other work without a note
    """
    shown = [row for row in rows if every or _is_news(row)]
    console = Console(width=None if sys.stdout.isatty() else 160)
    table = Table()
    for title in ('Student', 'Assignment', 'Done', 'Handed in', 'From', 'Notes'):
        table.add_column(title, overflow='fold')
    for row in shown:
        student = f'{row.student} ({row.person})' if row.person else row.student
        notes = '; '.join(row.notes)
        cells = (student, row.assignment, row.done, row.handed_in, row.place, notes)
        table.add_row(*(Text(printable(cell)) for cell in cells))
    if shown:
        console.print(table)
    counts = Counter(row.done for row in rows)
    said = ', '.join(f'{count} {done}' for done, count in sorted(counts.items()))
    where = f'Folder: {to}' if written else 'Nothing was written (--dry-run)'
    summary = f'{said or "no submissions"}. {where}. Times are UTC.'
    if hidden := len(rows) - len(shown):
        summary += f' Rows without news: {hidden} (--all shows them).'
    console.print(summary, markup=False, highlight=False, soft_wrap=True)


def _is_news(row: Row) -> bool:
    return row.done == LEFT or (bool(row.notes) and row.done != UNCHANGED)
