"""
Everything about the last grading, as data; docs/results.schema.json describes it.

``points`` of a submission and of its exams and checks are null while there is no mark: it is for
review, or only visible checks were run.
"""

from __future__ import annotations

from collections.abc import Iterable
import json
from typing import Any

from autograder.classroom.results_of_class import ClassResults
from autograder.exports.marks import automatic
from autograder.results import ExamResult, SubmissionResult

FORMAT = 'ros2-course-results'
VERSION = 1


def results_json(classes: Iterable[ClassResults]) -> bytes:
    """Return the document, in UTF-8."""
    data = {
        'format': FORMAT,
        'version': VERSION,
        'submissions': [_submission(one) for graded in classes for one in graded.results],
    }
    text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False)
    return f'{text}\n'.encode('utf-8', 'replace')  # a program may print half a character


def _submission(result: SubmissionResult) -> dict[str, Any]:
    mark = automatic(result)
    marked = mark.points is not None
    return {
        'assignment': result.assignment,
        'student': result.student,
        'status': mark.status,
        'points': mark.points,
        'max_points': result.max_points,
        'fault': result.fault,
        'flags': list(result.flags),
        'problems': [
            {
                'where': problem.where,
                'expected': problem.expected,
                'got': problem.got,
                'try_this': problem.try_this,
                'cells': list(problem.cells),
            }
            for problem in result.problems
        ],
        'exams': [_exam(exam, marked) for exam in result.exams],
    }


def _exam(exam: ExamResult, marked: bool) -> dict[str, Any]:
    return {
        'exam': exam.exam,
        'points': exam.points if marked else None,
        'max_points': exam.max_points,
        'note': exam.note,
        'isolation': exam.mode,
        'not_protected': list(exam.not_protected),
        'timing': dict(exam.timing),
        'recording': exam.recording,
        'checks': [
            {
                'check': check.check,
                'title': check.title,
                'verdict': check.verdict.value,
                'points': check.points if marked else None,
                'max_points': check.max_points,
                'expected': check.expected,
                'observed': check.observed,
                'cause': check.cause,
                'cause_id': check.cause_id,
                'try_this': check.try_this,
                'read': check.read,
                'waits_for': check.waits_for,
            }
            for check in exam.checks
        ],
    }
