"""
Enter assignments and results in nbgrader's gradebook, and remove students from it.

nbgrader's own Autograde enters the results, one student after another.  So formgrader, feedback
and export work as usual, and manual grades are kept.  The maximum of a cell comes from the
notebook, but its score from the exam.  If the two give different points, scores are wrong, and
nbgrader discards scores above the maximum; so the grader refuses such a lesson.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
import json
from pathlib import Path
import shutil
import tempfile
from typing import Any

from autograder.classroom.pages import write_all_reports
from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import results_file, results_of_others
from autograder.errors import ExamInvalid, GraderError
from autograder.exam.exam import Exam
from autograder.gradebook.database import has_gradebook, to_grade_by_hand
from autograder.gradebook.journal import autograded, drop
from autograder.grading.pipeline import Graded, Lesson
from autograder.layout import Layout
from autograder.submission.inbox import SECRET, STAMP
from autograder.submission.notebook import CHECK_PREFIX, is_check, marks_of, Notebook, read_release
from autograder.submission.reading import read_file


def enter_assignment(layout: Layout, assignment: str) -> None:
    """Enter the cells and points of an assignment in the gradebook, from its solution."""
    from autograder.gradebook import converters  # nbgrader takes seconds to import.

    layout.work.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix='release_', dir=layout.work) as folder:
        try:
            converters.generate(layout, assignment, Path(folder), database=True)
        except GraderError as error:
            if error.fix:  # The database or the disk failed.
                raise
            raise GraderError(
                error.what,
                'If cells of the assignment have changed since the last grading: restore them, '
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

    facts, people = {}, read_people(layout)
    with tempfile.TemporaryDirectory(prefix='staged_', dir=layout.work) as folder:
        for one in graded:
            if one.submission.recordable:
                student, same = one.result.student, _is_same_work(layout, lesson, one)
                name = people.get(student, '')
                facts[student] = {'result': one.result, 'same_work': same, 'name': name}
                _stage(Path(folder, student, lesson.assignment), lesson.notebook, one)
        if facts:
            converters.autograde(layout, lesson.assignment, Path(folder), facts)


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


def remove_entries(layout: Layout, students: Collection[str]) -> None:
    """Remove all entries of students from the journals, the gradebook and the reports."""
    # Start with the journals: an empty gradebook with non-empty journals is refused as damaged.
    for assignment in layout.assignments():
        drop(layout, assignment, students)
    if has_gradebook(layout):
        from autograder.gradebook import converters

        with converters.opened_gradebook(layout) as gradebook:
            for student in list(gradebook.students):
                if student.id in students:
                    gradebook.remove_student(student.id)
    for assignment in layout.assignments():
        if not results_file(layout, assignment).is_file():
            continue
        try:
            others = results_of_others(layout, assignment, students)
        except GraderError:
            continue  # The results are damaged; the next grading replaces them.
        if others:
            by_hand = to_grade_by_hand(layout, assignment, others)
            write_all_reports(layout, assignment, others, by_hand=len(by_hand))
        else:
            shutil.rmtree(layout.reports / assignment)


def _stage(folder: Path, notebook: str, graded: Graded) -> None:
    """Write the graded notebook to the folder from which nbgrader reads it."""
    from autograder.gradebook.grade_cells import to_node

    folder.mkdir(parents=True)
    text = json.dumps(to_node(graded.opened), indent=1, ensure_ascii=False)
    (folder / notebook).write_text(text, encoding='utf-8')
    stamp = timestamp_of(graded.submission.folder)
    if stamp:
        (folder / STAMP).write_text(stamp, encoding='utf-8')
    secret, _ = read_file(graded.submission.folder / SECRET, SECRET)
    if secret:
        (folder / SECRET).write_bytes(secret)


def timestamp_of(folder: Path) -> str:
    """Return the time of delivery; empty if it is invalid, because nbgrader would fail."""
    from nbgrader.utils import parse_utc

    data, _ = read_file(folder / STAMP, STAMP)
    text = (data or b'')[:100].decode('ascii', 'replace').strip()
    try:
        parse_utc(text)
    except (ValueError, OverflowError, TypeError):
        return ''
    return text


def points_mismatches(notebook: Notebook, where: str, exams: Sequence[Exam]) -> Iterator[str]:
    """Yield one line for each check cell of a notebook whose points differ from its exam's."""
    checks = [marks_of(cell) for cell in notebook['cells'] if is_check(cell)]
    cells = {one['grade_id'].removeprefix(CHECK_PREFIX): float(one['points']) for one in checks}
    gives = {exam.name: exam.max_points for exam in exams}
    for name in dict.fromkeys((*cells, *gives)):
        if name not in gives:
            yield f'{where}, cell {CHECK_PREFIX}{name}: this lesson has no exam {name}.'
        elif name not in cells:
            yield f'{where}: the exam {name} has no check cell below its answers.'
        elif abs(cells[name] - gives[name]) > 1e-9:
            yield (
                f'{where}, cell {CHECK_PREFIX}{name}: {cells[name]:g} points, but the exam gives '
                f'{gives[name]:g}.'
            )


def refuse_unfit_points(layout: Layout, lesson: Lesson) -> None:
    """Raise an ExamInvalid that names each check cell whose points differ from its exam."""
    release = '.venv/bin/autograder release'
    for folder, fix in (
        (layout.solutions, f'give the cell and the exam the same points, then {release}'),
        (layout.notebooks, release),
    ):
        path = folder / lesson.assignment / lesson.notebook
        if not path.is_file():
            continue  # nbgrader reports a missing notebook in more detail.
        where = path.relative_to(layout.root).as_posix()
        if wrong := list(points_mismatches(read_release(path), where, lesson.exams)):
            raise ExamInvalid(f'{" ".join(wrong)} No mark was changed.', f'Try: {fix}')
