"""Collect a class: read a source, copy the selected notebooks, and save a list of the others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from autograder.classroom.collected import (
    Delivered,
    keep_delivered,
    keep_not_collected,
    NotCollected,
)
from autograder.classroom.people import extensions, keep_people
from autograder.collect.choice import choose, Chosen, look, of_all
from autograder.collect.kinds.kind import EXCHANGE, Found, handed_in
from autograder.collect.namesakes import in_doubt, keep_namesakes, Namesakes, read_namesakes
from autograder.collect.owners import owner_rule, with_owners_checked
from autograder.collect.source.course import Course
from autograder.collect.source.tree import opened
from autograder.collect.table import LEFT, Row, unclaimed
from autograder.collect.write_copy import lay
from autograder.layout import Layout
from autograder.submission.tree import Tree, UnreadableError


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
    Collect a class.

    :param source: a folder or a zip file
    :param to: folder that receives ``STUDENT/ASSIGNMENT/NOTEBOOK.ipynb``
    :param assignment: the only assignment to collect; empty to recognise it from the notebooks
    :param kind: platform of the source; empty to recognise it
    :param write: False to only report what would be done
    :param prefix: the beginning to remove from the names of students' folders
    :param trust_names: whether to collect deliveries of an exchange that other users own
    :returns: the table
    :raises GraderError: if the source as a whole cannot be used, or ``extensions.csv`` is wrong
    """
    course = Course(layout)
    extensions(layout)  # report a wrong file before anything is copied
    with opened(source) as tree:
        there = handed_in(tree, course, kind, prefix)
        if there.kind == EXCHANGE:
            rule = owner_rule(layout, trust_names)
            there = replace(there, handed=with_owners_checked(there.handed, rule))
        chosen, others, known = _choose(there, course, assignment, tree.name)
        taken = [(one, _take(one, course, to, write)) for one in chosen]
        rows = [*_refused(tree), *there.left, *others, *(row for _, row in taken)]
    if any(one.when for one in chosen) and course.due.problem:
        rows.append(unclaimed('the gradebook', course.due.problem))
    if write:
        names = {row.student: row.person for row in rows if row.done != LEFT and row.person}
        numbers = [(one.handed, one.assignment) for one, row in taken if row.done != LEFT]
        left = list(_not_collected(rows, layout))
        names_there = {
            (one.assignment, row.student): Delivered(there.kind, row.place)
            for one, row in taken
            if row.done != LEFT
        }
        rows += _kept(
            layout.delivered, 'names of files', lambda: keep_delivered(layout, names_there)
        )
        rows += _kept(layout.people, 'names', lambda: keep_people(layout, names))
        rows += _kept(
            layout.namesakes,
            'student numbers from Moodle',
            lambda: keep_namesakes(layout, known, numbers),
        )
        if to.resolve() == layout.submitted.resolve():
            rows += _kept(
                layout.not_collected, 'the list', lambda: keep_not_collected(layout, left)
            )
    return sorted(rows, key=lambda row: (row.student, row.assignment, row.place))


def _choose(
    there: Found, course: Course, wanted: str, name: str
) -> tuple[list[Chosen], list[Row], Namesakes]:
    """
    Select the notebooks to collect.

    :param wanted: the only assignment, empty to recognise it from the notebooks
    :param name: name of the source, for error messages
    :returns: the notebooks, a row for each entry that was not collected, and the updated data
        about people with the same name
    """
    seen = [look(one, course, wanted) for one in there.handed]
    goal = wanted or (of_all(seen, course, name) if there.single else '')
    handed, known = in_doubt(there.handed, read_namesakes(course.layout), goal)
    delivered = [
        (one, [replace(each, handed=one) for each in notebooks])
        for one, notebooks in zip(handed, seen)
    ]
    return (*choose(delivered, course, goal, there.single), known)


def _kept(path: Path, what: str, keep: Callable[[], None]) -> Iterator[Row]:
    """Save data for later commands; if that fails, yield a row for the table."""
    try:
        keep()
    except OSError as error:
        why = f'{what} cannot be written: {(error.strerror or "error").lower()}'
        yield unclaimed(str(path), why)


def _not_collected(rows: Sequence[Row], layout: Layout) -> Iterator[NotCollected]:
    """Yield the work of known students that was not collected, for the reports."""
    known = layout.assignments()
    for row in rows:
        if row.done == LEFT and row.student:
            what = row.assignment if row.assignment in known else ''
            yield NotCollected(row.student, what, row.notes[0], row.person, row.handed_in)


def _refused(tree: Tree) -> Iterator[Row]:
    """Yield a row about files that were not read, one per folder and reason."""
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
        done, said = lay(one, course.file_names[one.assignment], to, write)
    except OSError as error:
        done, said = LEFT, f'cannot be written: {(error.strerror or "error").lower()}'
    except UnreadableError as error:
        done, said = LEFT, str(error)
    return one.row(done, course, said)
