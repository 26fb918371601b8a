"""
Enter assignments, results and names in nbgrader's gradebook.

nbgrader's own Autograde enters the results, one student after another.  So formgrader, feedback
and export work as usual, and manual grades are kept.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
import json
from pathlib import Path
import tempfile
from typing import Any

from autograder.classroom.people import read_people
from autograder.errors import GraderError
from autograder.gradebook.connection import GradebookRefusedError
from autograder.gradebook.journal import autograded
from autograder.grading.pipeline import Graded, Lesson
from autograder.layout import Layout
from autograder.submission.reading import read_file


def enter_assignment(layout: Layout, assignment: str) -> None:
    """
    Enter the cells and points of an assignment in the gradebook, from its solution.

    :raises GraderError: if nbgrader cannot enter the assignment
    """
    from autograder.gradebook import converters  # nbgrader takes seconds to import.

    layout.work.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix='release_', dir=layout.work) as folder:
        try:
            converters.generate(layout, assignment, Path(folder), database=True)
        except GradebookRefusedError:
            raise
        except GraderError as error:
            raise GraderError(
                error.what,
                'If the cells of the assignment changed since it was last graded: restore them, '
                'or export the marks, which include manual grades, and begin a new gradebook '
                '(see docs/gradebook.md).',
            ) from error


def record(layout: Layout, lesson: Lesson, graded: Sequence[Graded]) -> None:
    """
    Enter the results of a class in the gradebook, after :func:`enter_assignment`.

    A submission for review is entered with a reason instead of a score.

    :raises GraderError: if nbgrader could not enter some results; the others are entered
    """
    from autograder.gradebook import converters

    entered = [one for one in graded if one.submission.recordable]
    with tempfile.TemporaryDirectory(prefix='staged_', dir=layout.work) as folder:
        staged = Path(folder)
        for one in entered:
            _stage(staged / one.result.student / lesson.assignment, lesson.notebook, one)
        results = {one.result.student: one.result for one in entered}
        same = {one.result.student for one in entered if _is_same_work(layout, lesson, one)}
        if results:
            converters.autograde(layout, lesson.assignment, staged, results, same)
            _name(layout, results)


def _is_same_work(layout: Layout, lesson: Lesson, graded: Graded) -> bool:
    """Return whether the answers have not changed since the last entry."""
    try:
        text = autograded(layout, lesson, graded).read_text(encoding='utf-8')
        return _answers(json.loads(text)) == _answers(graded.opened.notebook)
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return False  # The file is missing, or was changed after nbgrader wrote it.


def _answers(notebook: Mapping[str, Any]) -> dict[str, str]:
    """Return the content of the cells that students may edit, by grade id."""
    found = {}
    for cell in notebook['cells']:
        marks = cell['metadata'].get('nbgrader', {})
        if marks.get('solution') or marks.get('task'):
            found[marks['grade_id']] = ''.join(cell['source'])
    return found


def _name(layout: Layout, students: Collection[str]) -> None:
    """Add missing names of students to the gradebook, for formgrader."""
    from autograder.gradebook import converters

    people = {one: name for one, name in read_people(layout).items() if one in students}
    if not people:
        return
    with converters.opened_gradebook(layout) as gradebook:
        for student in gradebook.students:
            if student.id in people and not (student.first_name or student.last_name):
                first, _, last = people[student.id].rpartition(' ')
                # Store a single-word name as last_name, because formgrader shows "last, first".
                gradebook.update_or_create_student(
                    student.id, first_name=first or student.id, last_name=last
                )


def forget_students(layout: Layout, names: Collection[str]) -> None:
    """Remove students and all their data from the gradebook."""
    from autograder.gradebook import converters

    with converters.opened_gradebook(layout) as gradebook:
        for student in list(gradebook.students):
            if student.id in names:
                gradebook.remove_student(student.id)


def _stage(folder: Path, notebook: str, graded: Graded) -> None:
    """Write the graded notebook to the folder from which nbgrader reads it."""
    from autograder.gradebook.grade_cells import to_node

    folder.mkdir(parents=True)
    text = json.dumps(to_node(graded.opened), indent=1, ensure_ascii=False)
    (folder / notebook).write_text(text, encoding='utf-8')
    stamp = timestamp_of(graded.submission.folder)
    if stamp:
        (folder / 'timestamp.txt').write_text(stamp, encoding='utf-8')


def timestamp_of(folder: Path) -> str:
    """Return the time of delivery; empty if it is invalid, because nbgrader would fail."""
    from nbgrader.utils import parse_utc

    data, _ = read_file(folder / 'timestamp.txt', 'timestamp.txt')
    text = (data or b'')[:100].decode('ascii', 'replace').strip()
    try:
        parse_utc(text)
    except (ValueError, OverflowError, TypeError):
        return ''
    return text
