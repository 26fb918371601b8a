"""
Read the class list, the extensions, and the names of students whose id is a number.

The first two are CSV files that the instructor writes in the work folder; each is optional.
``class_list.csv`` has the columns ``student`` and, optionally, ``name``.  ``extensions.csv`` has
``student``, ``assignment`` and ``hours``; an empty assignment means all assignments.  Other
columns are ignored, so a download from a learning platform needs only a renamed column.
``collect`` saves the names that it finds.
"""

from collections.abc import Collection, Mapping, Sequence
from datetime import timedelta
import math
from pathlib import Path
from typing import Any
import unicodedata

from autograder.classroom.tables import parse_table, read_bytes, read_json, save_json
from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.submission.ids import named_id

MAX_HOURS = 24 * 366
LONGEST_NAME = 200
KEPT = frozenset('\t\n\r\u200c\u200d')
"""Unprintable characters to keep: line breaks become spaces, and Persian words need joiners."""


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

    :raises GraderError: if the class list is wrong
    """
    return {**saved_people(layout), **_clean(class_list(layout))}


def saved_people(layout: Layout) -> dict[str, str]:
    """Return the names that ``collect`` has saved, by student id; empty if the file is damaged."""
    found = read_json(layout.people)
    return _clean(found) if isinstance(found, dict) else {}


def student_named(layout: Layout, name: str, students: Collection[str]) -> str:
    """
    Return the id of the student with this id or display name, or an empty string.

    :param students: ids of the students to search
    :raises GraderError: if several students have the name
    """
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


def save_people(layout: Layout, names: Mapping[str, str]) -> None:
    """
    Save display names; a new name of a student replaces the old name.

    :param names: names by student id, as written in a source
    :raises OSError: if the file cannot be written
    """
    merged = {**saved_people(layout), **_clean(names)}
    save_json(layout.people, dict(sorted(merged.items())))


def _clean(names: Mapping[str, Any]) -> dict[str, str]:
    """Return each name as one printable line of limited length; leave out empty names."""
    found = {}
    for student, name in names.items():
        if isinstance(name, str):
            start = name[: 4 * LONGEST_NAME]
            kept = ''.join(char for char in start if char.isprintable() or char in KEPT)
            if shown := ' '.join(kept.split()):
                found[student] = shown[:LONGEST_NAME].rstrip()
    return found
