"""
Remove a student from the course, with everything that the grader derived from their work.

The submission itself is not deleted.  If the next grading would find it, it is moved to
``_work/forgotten``.  Recordings are kept: they are named by the content of the files, and students
with equal files share them.
"""

import argparse
from collections.abc import Collection
from contextlib import nullcontext
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
import shutil
import time

from sqlalchemy import text

from autograder.classroom.collected import read_collected, save_collected, Work
from autograder.classroom.course_lock import lock_course
from autograder.classroom.people import student_named
from autograder.classroom.results_of_class import last_results, results_file
from autograder.commands import flag, OK, option, takes
from autograder.commands.grade import relative_path
from autograder.errors import GraderError
from autograder.explaining.feedback import number, printable
from autograder.gradebook.database import query, save_copy
from autograder.gradebook.journal import read_notes
from autograder.gradebook.record import remove_entries
from autograder.layout import Layout
from autograder.submission.inbox import students_in

OF_EARLIER_VERSIONS = ('people.json', 'delivered.json', 'not_collected.json', 'namesakes.json')
"""Files of ``collect`` with data about all students, which no command reads any more."""


@takes(
    option('students', 'id or name of the student', nargs='+', metavar='STUDENT'),
    flag('--yes', 'remove everything that is listed'),
)
def run(chosen: argparse.Namespace) -> int:
    """Print all data about some students; with ``--yes``, also remove it."""
    layout, copies = Layout.here(), []
    with lock_course(layout, 'forget') if chosen.yes else nullcontext():
        found = tuple(dict.fromkeys(traces(layout, student) for student in chosen.students))
        for one in found:
            print(printable('\n  '.join([f'{one.student}:', *one.lines])))
        if chosen.yes:
            copies = [forget(layout, one) for one in found]
    if not chosen.yes:
        print('Nothing was removed. To remove all this, run the same command with --yes')
        return OK
    print('Removed. Earlier exports and copies of the gradebook are unchanged.')
    if copies[0]:
        print(f'Copy of the gradebook before the removal: {copies[0]}')
    return OK


@dataclass(frozen=True)
class Traces:
    """
    All data about one student in a course.

    :param lines: one line for each item that would be removed, moved or kept
    :param made: folders that nbgrader generated from the work
    :param moved: the folder of the submission if the next grading would find it, else None
    """

    student: str
    lines: tuple[str, ...]
    made: tuple[Path, ...]
    moved: Path | None


def traces(layout: Layout, student: str) -> Traces:
    """
    Return all data about one student, without changing anything.

    :param student: id or display name
    :raises GraderError: if there is no such student, or several have the name
    """
    marks, saved = _marks(layout), read_collected(layout)
    graded = {
        one: {result.student for result in last_results(layout, one)}
        for one in layout.assignments()
        if results_file(layout, one).is_file()
    }
    made = [layout.work / 'autograded', layout.work / 'feedback']
    folders = {above: _folders(above) for above in (layout.submitted, *made)}
    known = {*marks, *(one.student for one in saved)}
    known.update(*folders.values(), *graded.values())
    student = _named(layout, student, known)
    has_results = [name for name, students in graded.items() if student in students]
    entered = [one for one in layout.assignments() if student in read_notes(layout, one)]
    theirs = tuple(above / student for above in made if student in folders[above])
    lines = [
        *(f'gradebook: {mark}' for mark in marks.get(student, ())),
        f'reports: result and page of {", ".join(has_results)}' if has_results else '',
        f'journal of the gradebook: {", ".join(entered)}' if entered else '',
        *(_in_words(one) for one in saved if one.student == student),
        *(f'folder: {relative_path(folder, layout)}' for folder in theirs),
    ]
    lines += [
        f'file of an earlier version, no longer read: {relative_path(path, layout)}'
        for path in (layout.work / name for name in OF_EARLIER_VERSIONS)
        if path.is_file()
    ]
    moved, place = None, layout.submitted / student
    if student in folders[layout.submitted]:
        line = f'not touched: {relative_path(place, layout)}'
        if student in students_in(layout.submitted, layout.assignments()):
            moved, to = place, relative_path(layout.work / 'forgotten', layout)
            line = f'moved to {to} so that it is not graded again: {relative_path(place, layout)}'
        lines.append(line)
    return Traces(student, tuple(filter(None, lines)), theirs, moved)


def _named(layout: Layout, name: str, known: Collection[str]) -> str:
    """Return the id of the student with this id or display name."""
    if student := student_named(layout, name, known):
        return student
    close = get_close_matches(name, known, n=3)
    raise GraderError(
        printable(f'{name}: there is no such student.'),
        printable(f'Did you mean {", ".join(close)}?') if close else '',
    )


def forget(layout: Layout, found: Traces) -> Path | None:
    """
    Remove all data about a student.

    :param found: from :func:`traces`
    :returns: a copy of the gradebook before the removal; None if the gradebook is on a server or
        has no submission
    :raises GraderError: if the gradebook cannot be written or copied
    """
    student, copy = found.student, save_copy(layout)
    # Move the submission first: a grading that found it would undo the removal.
    if found.moved:
        now = time.strftime('%Y-%m-%d_%H%M%SZ', time.gmtime())
        place = layout.work / 'forgotten' / f'{student}_{now}'
        place.parent.mkdir(exist_ok=True)
        found.moved.rename(place)
    # Then what collect has saved, because the removal of results rewrites the reports.
    save_collected(layout, (), without=student)
    remove_entries(layout, {student})
    for folder in found.made:
        shutil.rmtree(folder)
    for name in OF_EARLIER_VERSIONS:
        (layout.work / name).unlink(missing_ok=True)
    return copy


def _in_words(one: Work) -> str:
    """Return an entry of ``collect`` as one line."""
    facts = (one.person, one.assignment, one.place, one.why, 'two people' if one.shared else '')
    return f'saved by collect: {", ".join(filter(None, facts))}'


def _folders(above: Path) -> set[str]:
    """Return the names of the subfolders of a folder, without links; empty if it is missing."""
    if not above.is_dir():
        return set()
    return {one.name for one in above.iterdir() if one.is_dir() and not one.is_symlink()}


def _marks(layout: Layout) -> dict[str, list[str]]:
    """Return the marks of each student in the gradebook as text, one line per assignment."""
    found: dict[str, list[str]] = {
        str(student): [] for (student,) in query(layout, text('select id from student'))
    }
    for student, assignment, automatic, by_hand in query(layout, text(_SUMS)):
        given = f', {number(by_hand)} of them given by hand' if by_hand is not None else ''
        found[str(student)].append(f'{assignment}, {number(automatic)} points{given}')
    return {student: marks or ['no submission'] for student, marks in found.items()}


_SUMS = """
select submitted_assignment.student_id, assignment.name,
       sum(coalesce(grade.manual_score, grade.auto_score, 0) + coalesce(grade.extra_credit, 0)),
       sum(grade.manual_score)
from grade
join submitted_notebook on submitted_notebook.id = grade.notebook_id
join submitted_assignment on submitted_assignment.id = submitted_notebook.assignment_id
join assignment on assignment.id = submitted_assignment.assignment_id
group by submitted_assignment.student_id, assignment.name
order by assignment.name
"""
