"""
Find the marks in the gradebook that new results would lower or clear.

The current marks are compared with the marks after the entry, including manual grades and late
penalties.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import TYPE_CHECKING

from autograder.classroom.class_list import extensions
from autograder.explaining.feedback import number, printable
from autograder.gradebook.record import timestamp_of
from autograder.gradebook.settings import has_gradebook, load_config
from autograder.grading.pipeline import Graded, Lesson
from autograder.layout import Layout

if TYPE_CHECKING:
    from nbformat import NotebookNode
    from nbgrader.api import SubmittedAssignment


@dataclass(frozen=True)
class LoweredMark:
    """
    A mark that would be lowered or cleared.

    :param emptied: grade ids of the check cells that would lose their score
    """

    student: str
    before: float
    after: float
    emptied: tuple[str, ...] = ()

    def text(self) -> str:
        """Return the change as text, such as ``ann 40 to 27``."""
        empty = f', no score for {", ".join(self.emptied)}' if self.emptied else ''
        return printable(f'{self.student} {number(self.before)} to {number(self.after)}{empty}')


def lowered_marks(layout: Layout, lesson: Lesson, graded: Sequence[Graded]) -> list[LoweredMark]:
    """
    Return the marks that entering results would lower or clear.

    :param graded: the results that are about to be entered
    :raises GraderError: if the gradebook cannot be read
    """
    if not has_gradebook(layout):
        return []  # Opening the gradebook would create it.
    from nbformat import from_dict
    from nbgrader.api import MissingEntry

    from autograder.gradebook.converters import opened_gradebook
    from autograder.gradebook.grade_cells import is_check

    found: list[LoweredMark] = []
    checks = [cell for cell in from_dict(lesson.release).cells if is_check(cell)]
    with opened_gradebook(layout) as gradebook:
        for one in graded:
            with suppress(MissingEntry):
                submission = gradebook.find_submission(lesson.assignment, one.result.student)
                found += _compare(layout, one, submission, checks)
    return found


def _compare(
    layout: Layout, graded: Graded, submission: SubmittedAssignment, checks: Sequence[NotebookNode]
) -> Iterator[LoweredMark]:
    """Yield the mark of one submission if it would be lowered or cleared."""
    from autograder.gradebook.grade_cells import score_of

    new = {cell.metadata.nbgrader['grade_id']: score_of(cell, graded.result) for cell in checks}
    counted = [
        grade
        for notebook in submission.notebooks
        for grade in notebook.grades
        if grade.name in new and grade.auto_score is not None and grade.manual_score is None
    ]
    gain = sum((new[grade.name] or 0.0) - grade.auto_score for grade in counted)
    score = float(submission.score) + gain
    before, after = mark_of(submission), score - _penalty(layout, graded, submission, score)
    emptied = tuple(grade.name for grade in counted if new[grade.name] is None)
    if after < before - 1e-6 or emptied:
        yield LoweredMark(graded.result.student, before, after, emptied)


def mark_of(submission: SubmittedAssignment) -> float:
    """Return the points of a submission in the gradebook, minus its late penalty."""
    return max(0.0, float(submission.score) - float(submission.late_submission_penalty or 0.0))


def _due(layout: Layout, graded: Graded, submission: SubmittedAssignment) -> datetime | None:
    """Return the due date that the entry will set; None if there is none."""
    due, more = submission.assignment.duedate, extensions(layout)
    if due is None:
        return None
    if more is None:
        return due + (submission.extension or timedelta())
    return due + more.get((graded.result.student, submission.assignment.name), timedelta())


def _penalty(
    layout: Layout, graded: Graded, submission: SubmittedAssignment, score: float
) -> float:
    """Return the penalty that the late policy of the course assigns to a score."""
    from nbgrader.preprocessors import AssignLatePenalties
    from nbgrader.utils import parse_utc

    stamp = timestamp_of(graded.submission.folder)
    when = parse_utc(stamp) if stamp else submission.timestamp
    due = _due(layout, graded, submission)
    if when is None or due is None or when <= due:
        return 0.0
    policy = AssignLatePenalties(config=load_config(layout))
    policy.init_plugin()
    late_s = (when - due).total_seconds()
    penalty = policy.plugin_inst.late_submission_penalty(graded.result.student, score, late_s)
    return min(max(0.0, penalty or 0.0), score)
