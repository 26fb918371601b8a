"""
Export all results of the last grading as JSON; docs/results.schema.json describes the format.

``points`` of a submission and of its exams and checks are null while there is no mark: the
submission is for review, or only visible checks were run.  ``missing`` names the students whose
current work has no result.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from autograder.exports.marks import automatic, Mark
from autograder.files import json_bytes
from autograder.results import ExamResult, SubmissionResult

FORMAT = 'ros2-course-results'
VERSION = 1


def results_json(marks: Sequence[Mark]) -> bytes:
    """Return the document, in UTF-8."""
    data = {
        'format': FORMAT,
        'version': VERSION,
        'submissions': [submission_json(mark.result) for mark in marks if mark.result],
        'missing': [
            {'assignment': mark.assignment, 'student': mark.student, 'status': mark.status}
            for mark in marks
            if not mark.result
        ],
    }
    return json_bytes(data)


def submission_json(result: SubmissionResult) -> dict[str, Any]:
    """Return one item of ``submissions``."""
    mark = automatic(result)
    problems = [asdict(problem) for problem in result.problems]
    return {
        'assignment': result.assignment,
        'student': result.student,
        'status': mark.status,
        'points': mark.points,
        'max_points': result.max_points,
        'fault': result.fault,
        'flags': list(result.flags),
        'problems': [_without(problem, 'unusable') for problem in problems],
        'exams': [_exam(exam, mark.points is not None) for exam in result.exams],
    }


def _exam(exam: ExamResult, marked: bool) -> dict[str, Any]:
    found = _without(exam.to_json(), 'flags', 'pictures', 'mode')
    found |= {'isolation': exam.mode, 'points': exam.points, 'max_points': exam.max_points}
    for one in () if marked else (found, *found['checks']):
        one['points'] = None
    return found


def _without(data: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {name: value for name, value in data.items() if name not in names}
