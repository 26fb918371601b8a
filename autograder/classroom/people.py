"""
Read the class list, the extensions and the names of students.

The first two are CSV files that the instructor writes in the work folder; each is optional.
``class_list.csv`` has the columns ``student`` and, optionally, ``name``, or is a gradebook from
Canvas or a list of participants from Moodle.  ``extensions.csv`` has ``student``, ``assignment``
and ``hours``; an empty assignment means all assignments.  Other columns are ignored.  ``collect``
saves the names that it finds.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from datetime import timedelta
from difflib import get_close_matches
import math
from pathlib import Path
import unicodedata

from autograder.classroom.collected import collected_names, printable_name, read_collected
from autograder.classroom.tables import parse_table, read_bytes
from autograder.errors import GraderError
from autograder.explaining.feedback import printable
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
    for where, row in _rows(layout.class_list, ('student',), _listed):
        student = _student(where, row)
        if student in found:
            raise GraderError(
                f'{where}: {student} is in the list twice.',
                'Try: delete one of the two lines; if these are two people, add an id to both '
                'names, as to the names of their folders (docs/collect.md)',
            )
        found[student] = row.get('name', '').strip()
    return found


def _listed(row: Mapping[str, str]) -> Mapping[str, str]:
    """Return a row with the columns of a class list, empty if it is no student's."""
    from_canvas = any(column.startswith('sis ') for column in row)
    if from_canvas and 'name' not in row and {'student', 'id', 'section'} <= row.keys():
        last, _, first = row['student'].strip().partition(', ')
        absent = not row['id'].strip() or (last, first) == ('Student', 'Test')
        return {} if absent else {'student': row['id'], 'name': f'{first} {last}'.strip()}
    if 'student' not in row and {'first name', 'last name'} <= row.keys():  # Moodle's participants
        name = f'{row["first name"].strip()} {row["last name"].strip()}'.strip()
        return {'student': name, 'name': name}
    return row


def extensions(layout: Layout) -> dict[tuple[str, str], timedelta] | None:
    """
    Return the extra time of individual students, by student and assignment.

    :returns: None if there is no ``extensions.csv``, so that extensions in the gradebook count
    :raises GraderError: if the file cannot be read, or has an unknown assignment or invalid hours
    """
    if not layout.extensions.exists():
        return None
    listed = class_list(layout)
    folders = [one.name for one in layout.submitted.glob('*')]
    known = dict.fromkeys((*listed, *folders, *map(student_id, folders)), '') | read_people(layout)
    every: dict[tuple[str, str], timedelta] = {}
    found: dict[tuple[str, str], timedelta] = {}
    for where, row in _rows(layout.extensions, ('student', 'assignment', 'hours')):
        name, hours = row['assignment'].strip(), _hours(where, row)
        _student(where, row)  # Refuse an empty id.
        try:
            student = _extended(layout, row['student'].strip(), known, bool(listed))
            if name:
                found[student, layout.assignment_named(name)] = hours
            else:
                every |= {(student, one): hours for one in layout.assignments()}
        except GraderError as error:
            raise GraderError(f'{where}: {error.what}', error.fix) from error
    return {**every, **found}


def _extended(layout: Layout, name: str, people: Mapping[str, str], listed: bool) -> str:
    """
    Return the student id for an id or a display name in the extensions.

    :param people: names of all known students by id, maybe empty
    :param listed: whether there is a class list; without one, a student may be unknown until their
        work is collected, so only a difference in accents or case is an error
    :raises GraderError: if the course does not have the student
    """
    if named_id(name) in people:
        return named_id(name)
    if student := student_named(layout, name, people.keys()):
        return student
    known = [*people, *people.values()]
    plain = {_folded(one, accents=False) for one in known}
    if listed or _folded(name, accents=False) in plain:
        fix = close_names(name, known) or 'Try: use the id in the class list, or delete the row'
        raise GraderError(f'there is no student {printable(name)}.', fix)
    return named_id(name)


def _rows(
    path: Path,
    needed: Sequence[str],
    read: Callable[[Mapping[str, str]], Mapping[str, str]] = dict,
) -> Sequence[tuple[str, Mapping[str, str]]]:
    """
    Return the place of each row in a file, and its cells by column name.

    :param read: returns a row with the needed columns, empty to skip it
    """
    if not path.exists():
        return ()
    fix = f'Try: write a CSV file with the columns {", ".join(needed)}'
    try:
        table = parse_table(read_bytes(path, 'the file', fix))
    except ValueError as error:
        raise GraderError(f'{path}: {error}.', fix) from error
    header = [name.strip().lower() for name in table.header]
    if missing := [name for name in needed if name not in read(dict(zip(header, header)))]:
        raise GraderError(f'{path}: there is no column {", ".join(missing)}.', fix)
    return [
        (f'{path}, row {number}', cells)
        for number, row in enumerate(table.rows[1:], start=2)
        if any(cell.strip() for cell in row) and (cells := read(dict(zip(header, row))))
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


def find_student(layout: Layout, name: str, students: Collection[str]) -> str:
    """Return the student with this id or display name; GraderError if it is not exactly one."""
    if student := student_named(layout, name, students):
        return student
    people = read_people(layout)
    known = [*students, *(people[one] for one in students if one in people)]
    fix = close_names(name, known) or 'Try: the id, or the full name in quotes'
    raise GraderError(f'{printable(name)}: there is no such student.', fix)


def close_names(name: str, known: Iterable[str]) -> str:
    """Return a question that suggests similar names; empty if there are none."""
    plain = {_folded(one, accents=False): one for one in known}
    word = _folded(name, accents=False)
    found = [one for one in plain if word in one.split()] or get_close_matches(word, plain, n=3)
    names = (f'"{plain[one]}"' if ' ' in plain[one] else plain[one] for one in found[:3])
    return printable(f'Did you mean {", ".join(names)}?') if found else ''


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


def _folded(name: str, accents: bool = True) -> str:
    """Normalise the case, the spaces and, on request, the accents of a name for comparison."""
    text = unicodedata.normalize('NFKC' if accents else 'NFKD', name)
    kept = ''.join(char for char in text if accents or not unicodedata.combining(char))
    return ' '.join(kept.casefold().split())


def not_listed(layout: Layout, students: Collection[str]) -> tuple[str, ...]:
    """Return the students who are not on the class list; none if there is no list."""
    known = class_list(layout)
    here = (one for one in students if known.keys().isdisjoint((one, student_id(one))))
    return tuple(here) if known else ()
