"""
Remove a student from the course, with everything that grading made from their work.

The submission is not deleted.  If the next grading would find it again, it moves to
``_work/forgotten``.  Recordings are kept: they are named by the content of the files, and equal
files of several students share one.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
import shutil
import time

from sqlalchemy import text

from autograder.classroom.course_lock import alone
from autograder.classroom.not_collected import forget_not_collected, read_not_collected
from autograder.classroom.people import namesake, read_people
from autograder.classroom.results_of_class import last_results, results_file
from autograder.collect.namesakes import keep_namesakes, read_namesakes
from autograder.commands import flag, OK, option, takes
from autograder.commands.grade import short
from autograder.errors import GraderError
from autograder.explaining.feedback import number, printable
from autograder.files import json_bytes, keep
from autograder.gradebook.connection import query
from autograder.gradebook.copies import keep_copy
from autograder.gradebook.forget import forget_made
from autograder.gradebook.journal import journal, noted
from autograder.layout import Layout
from autograder.submission.inbox import students_in


@takes(
    option('students', 'id or name of the student', nargs='+', metavar='STUDENT'),
    flag('--yes', 'remove everything that is listed'),
)
def run(chosen: argparse.Namespace) -> int:
    """Print all data about students, and remove it with ``--yes``."""
    layout, copies = Layout.here(), []
    with alone(layout, 'forget') if chosen.yes else nullcontext():
        found = [traces(layout, student) for student in chosen.students]
        for one in found:
            print(printable('\n'.join(one.lines(layout))))
        if chosen.yes:
            copies = [forget(layout, one.student) for one in found]
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

    :param marks: marks in the gradebook, one line per assignment
    :param results: assignments with a result and a page in the reports
    :param journals: assignments in whose journal the student is
    :param name: the name, empty if none is known
    :param refused: why deliveries were not collected
    :param made: folders that nbgrader generated from the work
    :param left: the folder of the submission, if it has no notebook of the course
    :param moved: the same, if the next grading would find it
    """

    student: str
    marks: tuple[str, ...] = ()
    results: tuple[str, ...] = ()
    journals: tuple[str, ...] = ()
    name: str = ''
    refused: tuple[str, ...] = ()
    made: tuple[Path, ...] = ()
    left: Path | None = None
    moved: Path | None = None

    def lines(self, layout: Layout) -> Iterator[str]:
        """Yield what would be removed and what would not."""
        yield f'{self.student}:'
        yield from (f'  gradebook: {mark}' for mark in self.marks)
        if self.results:
            yield f'  reports: result and page of {", ".join(self.results)}'
        if self.journals:
            yield f'  journal of the gradebook: {", ".join(self.journals)}'
        if self.name:
            yield f'  name: {self.name}'
        yield from (f'  reports: {reason}' for reason in self.refused)
        yield from (f'  folder: {short(folder, layout)}' for folder in self.made)
        if self.moved:
            to, folder = short(_forgotten(layout), layout), short(self.moved, layout)
            yield f'  moved to {to} so that it is not graded again: {folder}'
        if self.left:
            yield f'  not touched: {short(self.left, layout)}'


def traces(layout: Layout, student: str) -> Traces:
    """
    Return all data about a student; change nothing.

    :param student: id or display name
    :raises GraderError: if there is no such student, or several have the name
    """
    marks = _marks(layout)
    results = {
        one: {result.student for result in last_results(layout, one)}
        for one in layout.assignments()
        if results_file(layout, one).is_file()
    }
    people, handed_in = read_people(layout), _folders(layout.submitted)
    missing = [one for one in read_not_collected(layout) if one.student == student]
    made = [layout.work / name for name in ('autograded', 'feedback')]
    known = {*marks, *people, *handed_in, *(name for above in made for name in _folders(above))}
    known = known.union(*results.values())
    if student not in known and not missing:
        if found := namesake(layout, student, known):
            return traces(layout, found)
        close = get_close_matches(student, known, n=3)
        raise GraderError(
            printable(f'{student}: there is no such student.'),
            printable(f'Did you mean {", ".join(close)}?') if close else '',
        )
    folder = layout.submitted / student if student in handed_in else None
    graded = folder and student in students_in(layout.submitted, layout.assignments())
    return Traces(
        student,
        tuple(marks.get(student, ())),
        tuple(one for one, students in results.items() if student in students),
        tuple(one for one in layout.assignments() if student in noted(journal(layout, one))),
        people.get(student, ''),
        tuple(one.reason for one in missing),
        tuple(above / student for above in made if student in _folders(above)),
        None if graded else folder,
        folder if graded else None,
    )


def forget(layout: Layout, student: str) -> Path | None:
    """
    Remove what :func:`traces` lists.

    :returns: a copy of the gradebook as it was, None if it is on a server or does not exist yet
    :raises GraderError: if the gradebook cannot be written or copied
    """
    found = traces(layout, student)
    copy = keep_copy(layout)
    # Move the submission first: a grading that found it would undo the removal.
    if found.moved:
        now = time.strftime('%Y-%m-%d_%H%M%SZ', time.gmtime())
        place = _forgotten(layout) / f'{student}_{now}'
        place.parent.mkdir(exist_ok=True)
        found.moved.rename(place)
    forget_not_collected(layout, student)
    forget_made(layout, {student})
    for folder in found.made:
        shutil.rmtree(folder)
    _forget_name(layout, student)
    return copy


def _forgotten(layout: Layout) -> Path:
    """Return the folder for submissions of forgotten students."""
    return layout.work / 'forgotten'


def _folders(above: Path) -> set[str]:
    """Return the names of the real folders in a folder, which may be missing."""
    if not above.is_dir():
        return set()
    return {one.name for one in above.iterdir() if one.is_dir() and not one.is_symlink()}


def _marks(layout: Layout) -> dict[str, list[str]]:
    """Return the marks in the gradebook, by student."""
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


def _forget_name(layout: Layout, student: str) -> None:
    """Remove a student from the display names and from Moodle's numbers."""
    known = read_namesakes(layout)
    if known.numbers.pop(student, None):
        keep_namesakes(layout, known, ())
    people = read_people(layout)
    if people.pop(student, ''):
        keep(layout.people, json_bytes(people))
