"""
The command ``collect``: what students handed in elsewhere, laid where nbgrader looks for it.

Each file is written whole or not at all, the source is only read, and everything that was found is
in one table: what was taken, what was not, and why.  Running it again changes nothing.

``tree`` lists a source, ``kinds`` tells who handed in what, ``choice`` which notebook is taken,
and ``laying`` writes it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from autograder.collect.choice import choose, Chosen, student_id
from autograder.collect.course import Course
from autograder.collect.kinds import handed_in
from autograder.collect.laying import lay
from autograder.collect.table import LEFT, print_rows, REPLACED, Row, TAKEN, UNCHANGED
from autograder.collect.tree import opened, Tree, UnreadableError
from autograder.layout import Layout
from autograder.whole_class.people import keep_people

__all__ = [
    'LEFT',
    'REPLACED',
    'TAKEN',
    'UNCHANGED',
    'Row',
    'collect',
    'print_rows',
    'student_id',
]


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
    found: list[Chosen] = []
    with opened(source) as tree:
        there = handed_in(tree, course, kind)
        rows = list(_refused(tree))
        rows += [Row('', '', one.place, LEFT, (one.why,)) for one in there.left]
        for handed in there.handed:
            chosen, others = choose(handed, course, assignment)
            found += chosen
            rows += others
        for several in _by_owner(found).values():
            rows += _take(several, course, to, write)
    if any(one.when for one in found) and course.due.problem:
        rows.append(Row('', '', 'the gradebook', LEFT, (course.due.problem,)))
    if write:
        rows += _keep_names(rows, layout)
    return sorted(rows, key=lambda row: (row.student, row.assignment, row.place))


def _keep_names(rows: Sequence[Row], layout: Layout) -> list[Row]:
    """Keep the names of those whose work is there; return a line if that cannot be done."""
    here = [row for row in rows if row.done != LEFT and row.person]
    try:
        keep_people(layout, {row.student: row.person for row in here})
    except OSError as error:
        why = f'names cannot be written: {(error.strerror or "error").lower()}'
        return [Row('', '', str(layout.people), LEFT, (why,))]
    return []


def _refused(tree: Tree) -> Iterator[Row]:
    """Yield a line for what was not looked at, one for all that is in one entry."""
    paths = [where.split('/') for where, _ in tree.refused]
    tops = {file.parts[0] for file in tree.files} | {parts[0] for parts in paths}
    depth = 2 if len(tops) == 1 else 1  # a folder around everything tells nobody whose it is
    grouped: dict[tuple[str, ...], list[str]] = {}
    for where, why in tree.refused:
        grouped.setdefault((*where.split('/')[:depth], why), []).append(where)
    for (*_, why), places in grouped.items():
        more = (f'and {len(places) - 1} more there',) if len(places) > 1 else ()
        yield Row('', '', places[0], LEFT, (why, *more))


def _by_owner(found: Sequence[Chosen]) -> dict[tuple[str, str], list[Chosen]]:
    """Return what belongs together, the newest with cells of the assignment first."""
    owners: dict[tuple[str, str], list[Chosen]] = {}
    for one in found:
        owners.setdefault((one.student, one.assignment), []).append(one)
    for several in owners.values():
        several.sort(
            key=lambda one: (
                not one.strange,
                one.when.timestamp() if one.when else 0.0,
                one.piece.turn,
                one.piece.place,
            ),
            reverse=True,
        )
    return owners


def _take(several: Sequence[Chosen], course: Course, to: Path, write: bool) -> list[Row]:
    """Lay the first of several where nbgrader looks, and say so for each of them."""
    newest, *others = several
    names = {one.handed.student for one in several}
    if len(names) > 1:  # two people whose names came out the same: nobody's work is lost unseen
        why = f'the same student id as {", ".join(map(repr, sorted(names)))}'[:160]
        return [one.row(LEFT, course, why) for one in several]
    notes = [f'the newest of {len(several)}'] if others else []
    if any(one.strange for one in others) and not newest.strange:
        notes = [f'the newest of {len(several)} with a cell of the assignment']
    try:
        done = lay(newest, course.file_names[newest.assignment], to, write)
    except OSError as error:
        done = LEFT
        notes.insert(0, f'cannot be written: {(error.strerror or "error").lower()}')
    except UnreadableError as error:
        done = LEFT
        notes.insert(0, str(error))
    rows = [newest.row(done, course, *notes)]
    for one in others:
        odd = one.strange and not newest.strange
        rows.append(one.row(LEFT, course, 'another one was taken' if odd else 'an earlier one'))
    return rows
