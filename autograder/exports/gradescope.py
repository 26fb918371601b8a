"""
Write ``results.json`` as Gradescope's autograder specification describes it.

The file has a score for each test, and their sum.  Text from students is always shown as plain
text, never as HTML.  Only instructors see the standard output of the grader.  By default, students
see the tests of the hidden exam when grades are published.  If they saw the tests earlier, they
could find out with many submissions what is tested.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
import json
from pathlib import Path
from typing import Any

from autograder.classroom.results_of_class import lacks, modes, seconds_of_exam
from autograder.errors import GraderError
from autograder.explaining.feedback import number, printable
from autograder.exports.marks import automatic
from autograder.files import json_bytes
from autograder.results import CheckResult, ExamResult, SubmissionResult, Verdict

VISIBILITIES = ('after_published', 'after_due_date', 'visible', 'hidden')
RESULTS = 'results.json'


def results_of(result: SubmissionResult, visibility: str = VISIBILITIES[0]) -> dict[str, Any]:
    """
    Return the content of ``results.json``.

    :param visibility: when students see the tests, one of :data:`VISIBILITIES`
    :raises GraderError: if there is no mark: Gradescope refuses a file without a score, but if the
        file is missing, it refers the student to the staff
    """
    mark = automatic(result)
    if mark.points is None:
        raise GraderError(
            f'{result.student}: {mark.status}, so there are no results.', result.review
        )
    return {
        'score': round(mark.points, 4),
        'execution_time': round(sum(map(seconds_of_exam, result.exams)), 2),
        'output': _about(result),
        'output_format': 'text',
        'test_output_format': 'text',
        'test_name_format': 'text',
        'visibility': visibility,
        'stdout_visibility': 'hidden',
        'tests': [
            _test(exam, check, f'{one}.{two}', visibility)
            for one, exam in enumerate(result.exams, start=1)
            for two, check in enumerate(exam.checks, start=1)
        ],
        'extra_data': {
            'assignment': result.assignment,
            'isolation': modes([result]),
            'recordings': {exam.exam: exam.recording for exam in result.exams if exam.recording},
            'flags': list(result.flags),
        },
    }


def results_bytes(result: SubmissionResult, visibility: str = VISIBILITIES[0]) -> bytes:
    """
    Return the content of ``results.json`` as bytes.

    :raises GraderError: if there is no mark
    """
    return json_bytes(results_of(result, visibility))


def results_in(folder: Path, assignment: str) -> Iterator[Path]:
    """Yield the files that an earlier export of an assignment wrote to a folder."""
    for path in folder.glob(f'*/{RESULTS}'):
        with suppress(OSError, ValueError, KeyError, TypeError):  # not a file of this export
            if json.loads(path.read_bytes())['extra_data']['assignment'] == assignment:
                yield path


def _about(result: SubmissionResult) -> str:
    """Return the points and notes about the submission as a whole, for the student."""
    lines = [f'{number(result.points)} of {number(result.max_points)} points of automatic checks']
    lines += [problem.line() for problem in result.problems]
    lines += [f'{exam.exam}: {exam.note}' for exam in result.exams if exam.note]
    lines += [f'Run with weak isolation: {lack}.' for lack in lacks([result])]
    return printable('\n'.join(lines))


def _test(exam: ExamResult, check: CheckResult, place: str, visibility: str) -> dict[str, Any]:
    return {
        'name': printable(f'{exam.exam}: {check.title}'),
        'number': place,
        'score': round(check.points, 4),
        'max_score': round(check.max_points, 4),
        'status': 'passed' if check.verdict is Verdict.PASSED else 'failed',
        'output': printable(_output(exam, check)),
        'output_format': 'text',
        'visibility': visibility,
    }


def _output(exam: ExamResult, check: CheckResult) -> str:
    """Return the feedback on a check for the student; empty if it passed."""
    if check.verdict is Verdict.PASSED:
        return ''
    if check.verdict is Verdict.NOT_RUN:
        titles = {one.check: one.title for one in exam.checks}
        return (
            f'Not checked, because it depends on: {titles.get(check.waits_for, check.waits_for)}'
        )
    return '\n'.join(f'{name.capitalize()}: {text}' for name, text in check.facts.items())
