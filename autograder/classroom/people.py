"""
Read the class list, the extensions, the names of students, and who has handed in nothing.

The first two are CSV files that the instructor writes in the work folder; each is optional.
``class_list.csv`` has the columns ``student`` and, optionally, ``name``.  ``extensions.csv`` has
``student``, ``assignment`` and ``hours``; an empty assignment means all assignments.  Other
columns are ignored, so a download from a learning platform needs only a renamed column.
``collect`` saves the names that it finds, and the work that it could not collect.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from datetime import timedelta
import math
from pathlib import Path
import unicodedata

from autograder.classroom.collected import (
    collected_names,
    NOTHING,
    printable_name,
    read_collected,
    read_not_collected,
    Work,
)
from autograder.classroom.tables import parse_table, read_bytes
from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.submission.inbox import named_id, student_id

MAX_HOURS = 24 * 366


def class_list(layout: Layout) -> dict[str, str]:
    """
    Return the students of the class with their names; empty if there is no list.

    :returns: names by student id, empty for a student without a name
    :raises GraderError: if the file cannot be read, or lacks an id or repeats one
    """
    found: dict[str, str] = {}
    for where, row in _rows(layout.class_list, ('student',)):
        student = _student(where, row)
        if student in found:
            raise GraderError(
                f'{where}: {student} is in the list twice.', 'Try: delete one of the two lines'
            )
        found[student] = row.get('name', '').strip()
    return found


def extensions(layout: Layout) -> dict[tuple[str, str], timedelta] | None:
    """
    Return the extra time of individual students, by student and assignment.

    :returns: None if there is no ``extensions.csv``, so that extensions in the gradebook count
    :raises GraderError: if the file cannot be read, or has an unknown assignment or invalid hours
    """
    if not layout.extensions.exists():
        return None
    every: dict[tuple[str, str], timedelta] = {}
    found: dict[tuple[str, str], timedelta] = {}
    for where, row in _rows(layout.extensions, ('student', 'assignment', 'hours')):
        student, name, hours = _student(where, row), row['assignment'].strip(), _hours(where, row)
        if name:
            try:
                key = student, layout.assignment_named(name)
            except GraderError as error:
                raise GraderError(f'{where}: {error.what}', error.fix) from error
            found[key] = hours
        else:
            every |= {(student, one): hours for one in layout.assignments()}
    return {**every, **found}


def _rows(path: Path, needed: Sequence[str]) -> Sequence[tuple[str, Mapping[str, str]]]:
    """Return the place of each row in a file, and its cells by column name."""
    if not path.exists():
        return ()
    fix = f'Try: write a CSV file with the columns {", ".join(needed)}'
    try:
        table = parse_table(read_bytes(path, 'the file', fix))
    except ValueError as error:
        raise GraderError(f'{path}: {error}.', fix) from error
    header = [name.strip().lower() for name in table.header]
    if missing := [name for name in needed if name not in header]:
        raise GraderError(f'{path}: there is no column {", ".join(missing)}.', fix)
    return [
        (f'{path}, row {number}', dict(zip(header, row)))
        for number, row in enumerate(table.rows[1:], start=2)
        if any(cell.strip() for cell in row)
    ]


def _student(where: str, row: Mapping[str, str]) -> str:
    """Return the student id of a row, as ``collect`` would write it."""
    student = named_id(row['student'].strip())
    if not student:
        raise GraderError(
            f'{where}: the student id {row["student"]!r} has no letter or digit.',
            'Try: use the id that collect shows for this student',
        )
    return student


def _hours(where: str, row: Mapping[str, str]) -> timedelta:
    try:
        hours = float(row['hours'].strip().replace(',', '.'))
    except ValueError:
        hours = math.nan
    if not 0 <= hours <= MAX_HOURS:
        raise GraderError(
            f'{where}: expected hours from 0 to {MAX_HOURS}, got {row["hours"]!r}.',
            'Try: write a number, such as 48 for two days',
        )
    return timedelta(hours=hours)


# -- names ----------------------------------------------------------------------------------


def read_people(layout: Layout) -> dict[str, str]:
    """
    Return the known names, by student id: from the class list, else from ``collect``.

    Platforms may shorten names, as Canvas does (``exampleann``); the class list has full names.

    :raises GraderError: if the class list is wrong, or the file of ``collect`` is damaged
    """
    listed = {student: printable_name(name) for student, name in class_list(layout).items()}
    saved = collected_names(read_collected(layout))
    return {**saved, **{one: name for one, name in listed.items() if name}}


def student_named(layout: Layout, name: str, students: Collection[str]) -> str:
    """Return the student with this id or display name, or ''; GraderError if several have it."""
    if name in students:
        return name
    people = {one: named for one, named in read_people(layout).items() if one in students}
    found = sorted(one for one, named in people.items() if _folded(named) == _folded(name))
    if len(found) > 1:
        raise GraderError(
            f'{name}: {len(found)} students have this name.',
            f'Try: use one of the ids {", ".join(found)}',
        )
    return found[0] if found else ''


def _folded(name: str) -> str:
    """Normalise the case and the spaces of a name for comparison."""
    return ' '.join(unicodedata.normalize('NFKC', name).casefold().split())


# -- missing students -----------------------------------------------------------------------


def not_collected(layout: Layout, assignment: str, graded: Collection[str]) -> tuple[Work, ...]:
    """
    Return the students who are missing from the results of an assignment.

    Their delivery could not be collected, or they are on the class list and handed in nothing.

    :raises GraderError: if the class list is wrong, or the file of ``collect`` is damaged
    """
    names = class_list(layout)
    found = [
        replace(one, person=names.get(one.student) or one.person)
        for one in read_not_collected(layout)
        if one.assignment in ('', assignment) and one.student not in graded
    ]
    # The class list contains ids from collect, but the folder of a submission may be named with
    # the original name: accept both.
    known = {*graded, *map(student_id, graded), *(one.student for one in found)}
    found += [
        Work(student, assignment, name, why=NOTHING)
        for student, name in names.items()
        if student not in known
    ]
    return tuple(sorted(found, key=lambda one: one.student))


def not_listed(layout: Layout, students: Collection[str]) -> tuple[str, ...]:
    """Return the students who are not on the class list; none if there is no list."""
    known = class_list(layout)
    here = (one for one in students if known.keys().isdisjoint((one, student_id(one))))
    return tuple(here) if known else ()


def names_for_email(missing: Sequence[Work]) -> str:
    """Return the names or ids of students, separated by commas, for an e-mail to them."""
    return ', '.join(dict.fromkeys(one.person or one.student for one in missing))
