"""
Remove a student from the course, with everything that the grader derived from their work.

The submission itself is not deleted.  If the next grading would find it, or if it contains work
that ``collect`` replaced, it is moved to ``_work/forgotten``.  Recordings are kept: they are named
by the content of the files, and students with equal files share them.
"""

import argparse
from collections.abc import Callable, Iterator, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
import shutil
import time

from sqlalchemy import text

from autograder.classroom.collected import read_collected, save_collected, Work
from autograder.classroom.course_lock import lock_course
from autograder.classroom.people import find_student
from autograder.classroom.results_of_class import last_results
from autograder.collect.copy_notebooks import KEPT
from autograder.commands import flag, OK, option, takes
from autograder.commands.grade import relative_path
from autograder.explaining.feedback import number, printable
from autograder.gradebook.database import query, save_copy
from autograder.gradebook.journal import read_notes
from autograder.gradebook.record import remove_entries
from autograder.layout import Layout
from autograder.submission.inbox import students_in

Trace = tuple[Sequence[str], Callable[[], object]]
"""Data about a student, one line for each item, and the function that removes this data."""


@takes(
    option('students', 'id or name of the student', nargs='+', metavar='STUDENT'),
    flag('--yes', 'remove everything that is listed'),
)
def run(chosen: argparse.Namespace) -> int:
    """Print all data about some students; with ``--yes``, also remove it."""
    layout = Layout.here()
    with lock_course(layout, 'forget') if chosen.yes else nullcontext():
        ids = dict.fromkeys(student_with_data(layout, name) for name in chosen.students)
        found = {student: list(traces(layout, student)) for student in ids}
        for student, there in found.items():
            lines = [line for said, _ in there for line in said]
            print(printable('\n  '.join([f'{student}:', *lines])))
        if not chosen.yes:
            print('Nothing was removed. To remove all this, run the same command with --yes')
            return OK
        copy = save_copy(layout)
        for there in found.values():
            for _, remove in there:
                remove()
    print('Removed. Earlier exports and copies of the gradebook are unchanged.')
    print('If you collect a download with their work again, they are back.')
    if copy:
        print(f'Copy of the gradebook before the removal: {copy}')
    return OK


def student_with_data(layout: Layout, name: str) -> str:
    """Return the id of a student with data, by id or name; GraderError if none or several fit."""
    known = {one.student for one in read_collected(layout)}
    known.update(str(one) for (one,) in query(layout, text('select id from student')))
    for above in (layout.submitted, layout.work / 'autograded', layout.work / 'feedback'):
        known.update(one.name for one in above.glob('*') if _is_folder(one))
    for assignment in layout.assignments():
        known.update(one.student for one in last_results(layout, assignment))
    return find_student(layout, name, known)


def traces(layout: Layout, student: str) -> Iterator[Trace]:
    """
    Yield all data about one student, without changing anything.

    The submission comes first, because a grading that found it would undo the removal.  Refused
    work comes before the results, because removing these rewrites the reports.  The other entries
    of ``collect`` come last: they contain the name, which is needed to repeat a failed removal.
    """
    place = layout.submitted / student
    if _is_folder(place):
        yield _submission(layout, place)
    saved = [one for one in read_collected(layout) if one.student == student]
    refused = [one for one in saved if one.why]
    others = [one for one in saved if not one.why]
    if refused:
        yield list(map(_in_words, refused)), partial(save_collected, layout, without=refused)
    yield list(_results(layout, student)), partial(remove_entries, layout, {student})
    for folder in (layout.work / 'autograded' / student, layout.work / 'feedback' / student):
        if _is_folder(folder):
            yield [f'folder: {relative_path(folder, layout)}'], partial(shutil.rmtree, folder)
    if others:
        yield list(map(_in_words, others)), partial(save_collected, layout, without=others)


def _submission(layout: Layout, place: Path) -> Trace:
    """
    Return the submission of a student.

    It is moved if the next grading would find it, or if ``collect`` kept replaced work in it.
    """
    where, kept = relative_path(place, layout), place.glob(f'*/{KEPT}/*.ipynb')
    if place.name not in students_in(layout.submitted, layout.assignments()) and not any(kept):
        return [f'not touched: {where}'], lambda: None
    forgotten = layout.work / 'forgotten'

    def move() -> None:
        forgotten.mkdir(exist_ok=True)
        now = time.strftime('%Y-%m-%d_%H%M%SZ', time.gmtime())
        place.rename(forgotten / f'{place.name}_{now}')

    to = relative_path(forgotten, layout)
    return [f'moved to {to} so that it is not graded again: {where}'], move


def _is_folder(path: Path) -> bool:
    """Return whether a path is a folder, not a link."""
    return path.is_dir() and not path.is_symlink()


def _in_words(one: Work) -> str:
    """Return an entry of ``collect`` as one line."""
    shared = 'two people have this id' if one.shared else ''
    facts = (one.person, one.assignment, one.place, one.why, shared)
    return f'saved by collect: {", ".join(filter(None, facts))}'


def _results(layout: Layout, student: str) -> Iterator[str]:
    """Yield the marks of a student in the gradebook, then the assignments with other results."""
    for name, points, by_hand in query(layout, text(MARKS), student=student):
        given = f', {number(by_hand)} of them given by hand' if by_hand is not None else ''
        yield f'gradebook: {name}, {number(points)} points{given}' if name else NO_MARKS
    for name in layout.assignments():
        if any(result.student == student for result in last_results(layout, name)):
            yield f'reports: result and page of {name}'
        if student in read_notes(layout, name):
            yield f'journal of the gradebook: {name}'


NO_MARKS = 'gradebook: no submission'
MARKS = """
select assignment.name,
       sum(coalesce(grade.manual_score, grade.auto_score, 0) + coalesce(grade.extra_credit, 0)),
       sum(grade.manual_score)
from student
left join submitted_assignment on submitted_assignment.student_id = student.id
left join assignment on assignment.id = submitted_assignment.assignment_id
left join submitted_notebook on submitted_notebook.assignment_id = submitted_assignment.id
left join grade on grade.notebook_id = submitted_notebook.id
where student.id = :student
group by assignment.name
order by assignment.name
"""
