"""
Return one mark per student of the class, from the automatic checks or from nbgrader's gradebook.

The gradebook's mark includes manual grades and late penalties; it exists only if nothing in the
submission waits for manual grading.  A student without a submission has no mark, never a zero.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from autograder.classroom.collected import NOTHING
from autograder.classroom.people import not_collected
from autograder.classroom.results_of_class import ClassResults, has_mark
from autograder.errors import GraderError
from autograder.gradebook.database import has_gradebook
from autograder.gradebook.live_entry import mark_of
from autograder.layout import Layout
from autograder.results import SubmissionResult

AUTOMATIC, GRADEBOOK = 'automatic', 'gradebook'
SOURCES = (AUTOMATIC, GRADEBOOK)
GRADED, REVIEW, BY_HAND, NOT_ENTERED, NO_GRADE, MISSING, NOT_COLLECTED = (
    'graded',
    'for review',
    'to be graded by hand',
    'not in the gradebook',
    'only visible checks were run',
    'nothing handed in',
    'not collected',
)


@dataclass(frozen=True)
class Mark:
    """
    The mark of a student in an assignment.

    :param points: None if there is no mark yet, which is not the same as zero
    :param status: one of the strings above; without a mark, it gives the reason
    :param late_points: points that nbgrader's late policy has already subtracted from ``points``
    :param result: the last result; None for a student without a submission
    """

    student: str
    points: float | None
    max_points: float
    status: str = GRADED
    late_points: float = 0.0
    assignment: str = ''
    result: SubmissionResult | None = None


def marks(layout: Layout, graded: ClassResults, source: str) -> list[Mark]:
    """
    Return the marks in the order of the results, then the students who have no result.

    :param source: one of :data:`SOURCES`
    :raises GraderError: if the source is the gradebook and it does not have the assignment, or if
        the class list is wrong
    """
    if source == AUTOMATIC:
        found = [automatic(result) for result in graded.results]
    else:
        found = from_gradebook(layout, graded.assignment, graded.results)
    most = max((mark.max_points for mark in found), default=0.0)
    for one in not_collected(layout, graded.assignment, {mark.student for mark in found}):
        status = MISSING if one.why == NOTHING else NOT_COLLECTED
        found.append(Mark(one.student, None, most, status, assignment=graded.assignment))
    return found


def automatic(result: SubmissionResult) -> Mark:
    """Return the mark from the automatic checks; visible checks alone give no mark."""
    status = REVIEW if result.review else GRADED if has_mark(result) else NO_GRADE
    points = result.points if status == GRADED else None
    return Mark(
        result.student,
        points,
        result.max_points,
        status,
        assignment=result.assignment,
        result=result,
    )


def from_gradebook(
    layout: Layout, assignment: str, results: Sequence[SubmissionResult]
) -> list[Mark]:
    """
    Return the marks in nbgrader's gradebook, in the order of the results.

    :raises GraderError: if there is no gradebook, or it does not have the assignment
    """
    from nbgrader.api import MissingEntry

    from autograder.gradebook.converters import opened_gradebook

    missing = GraderError(
        f'{assignment}: this assignment is not in the gradebook.',
        'Try: make grade, or --points automatic for the points of the checks alone',
    )
    if not has_gradebook(layout):
        raise missing  # Opening the gradebook would create an empty one.
    entered: dict[str, dict[str, Any]] = {}
    with opened_gradebook(layout) as gradebook:
        try:
            most = float(gradebook.find_assignment(assignment).max_score)
        except MissingEntry as error:
            raise missing from error
        for one in gradebook.assignment_submissions(assignment):
            late = float(one.late_submission_penalty or 0.0)
            entered[one.student.id] = (
                {'points': None, 'status': BY_HAND}
                if one.needs_manual_grade
                else {'points': mark_of(one), 'status': GRADED, 'late_points': late}
            )
    found = []
    for mark in map(automatic, results):
        # An unusable submission has no automatic mark, but an instructor can grade it by hand.
        if mark.points is not None or (mark.result and mark.result.unusable):
            there = entered.get(mark.student, {'points': None, 'status': NOT_ENTERED})
            mark = replace(mark, **there)
        found.append(replace(mark, max_points=most))
    return found
