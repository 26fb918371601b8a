"""
Compare the points of check cells with those of their exams.

nbgrader reads the maximum of a cell from the notebook and the score from the exam.  If the points
differ, the score is wrong, and nbgrader discards a score above the maximum.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from autograder.errors import ExamInvalid
from autograder.exam.exam import Exam
from autograder.grading.pipeline import Lesson
from autograder.layout import Layout
from autograder.submission.extract import CHECK_PREFIX
from autograder.submission.notebook import marks_of, Notebook, read_release


def unfit_points(notebook: Notebook, where: str, exams: Sequence[Exam]) -> Iterator[str]:
    """
    Yield one line for each check cell whose points differ from its exam's.

    :param where: name of the notebook in messages
    :param exams: all exams of the lesson
    """
    cells = {
        marks['grade_id'].removeprefix(CHECK_PREFIX): float(marks['points'])
        for cell in notebook['cells']
        if (marks := marks_of(cell)).get('grade') and not marks.get('solution')
        if cell['cell_type'] == 'code'
    }
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
    """
    Refuse a lesson whose check cells and exams give different points.

    :raises ExamInvalid: if there are such cells, in the solution or else in the release; the error
        names each of them
    """
    for folder, fix in (
        (layout.solutions, 'give the cell and the exam the same points, then make release'),
        (layout.notebooks, 'make release'),
    ):
        path = folder / lesson.assignment / lesson.notebook
        if not path.is_file():
            continue  # nbgrader reports a missing notebook in more detail.
        where = path.relative_to(layout.root).as_posix()
        if wrong := list(unfit_points(read_release(path), where, lesson.exams)):
            raise ExamInvalid(f'{" ".join(wrong)} No mark was changed.', f'Try: {fix}')
