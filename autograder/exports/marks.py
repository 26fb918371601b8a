"""
Return one mark per student of the class, from the automatic checks or from nbgrader's gradebook.

The gradebook's mark includes manual grades and late penalties; it exists only if nothing in the
submission waits for manual grading.  A student without a submission has no mark, never a zero, and
neither has a student whose work has changed since the last grading.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from typing import Any

from autograder.classroom.results_of_class import ClassResults
from autograder.classroom.standing import (
    BY_HAND,
    GRADED,
    NOT_ENTERED,
    standings,
    status_of,
    WITHOUT_RESULT,
)
from autograder.errors import GraderError
from autograder.gradebook.database import has_gradebook
from autograder.gradebook.live_entry import mark_of
from autograder.layout import Layout
from autograder.results import SubmissionResult

AUTOMATIC, GRADEBOOK = 'automatic', 'gradebook'
SOURCES = (AUTOMATIC, GRADEBOOK)


@dataclass(frozen=True)
class Mark:
    """
    The mark of a student in an assignment.

    :param points: None if there is no mark yet, which is not the same as zero
    :param status: a status of :mod:`autograder.classroom.standing`; without a mark, it gives the
        reason
    :param late_points: points that nbgrader's late policy has already subtracted from ``points``
    :param result: the last result; None if the student's current work has none
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
    name = graded.assignment
    states = standings(layout, name, graded.results)
    if source == AUTOMATIC:
        found = list(map(automatic, graded.results))
    else:
        found = from_gradebook(layout, name, graded.results)
    most = max((mark.max_points for mark in found), default=0.0)
    return [
        mark
        if mark and one.status not in WITHOUT_RESULT
        else Mark(one.student, None, most, one.status, assignment=name)
        for one, mark in zip_longest(states, found)
    ]


def automatic(result: SubmissionResult) -> Mark:
    """Return the mark from the automatic checks; visible checks alone give no mark."""
    status = status_of(result)
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
        there = entered.get(mark.student, {'points': None, 'status': NOT_ENTERED})
        # An unusable submission is for review until an instructor has graded it by hand.
        by_hand = mark.result and mark.result.unusable and there['status'] == GRADED
        if mark.points is not None or by_hand:
            mark = replace(mark, **there)
        found.append(replace(mark, max_points=most))
    return found
