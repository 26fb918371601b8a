"""
Export all results of the last grading as JSON; docs/results.schema.json describes the format.

``points`` of a submission, its exams and its checks are null if there is no mark: the submission
is for review, or only visible checks were run.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from autograder.classroom.results_of_class import ClassResults
from autograder.exports.marks import automatic
from autograder.files import json_bytes
from autograder.results import ExamResult, SubmissionResult

FORMAT = 'ros2-course-results'
VERSION = 1


def results_json(classes: Iterable[ClassResults]) -> bytes:
    """Return the results as a JSON document in UTF-8."""
    data = {
        'format': FORMAT,
        'version': VERSION,
        'submissions': [_submission(one) for graded in classes for one in graded.results],
    }
    return json_bytes(data)


def _submission(result: SubmissionResult) -> dict[str, Any]:
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
