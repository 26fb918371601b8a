"""Results survive a round trip through JSON, and their points add up."""

import json

from autograder.results import CheckResult, ExamResult, Problem, SubmissionResult, Verdict

PASSED = CheckResult('a', 'It runs.', Verdict.PASSED, 2, 2)
FAILED = CheckResult('b', 'It warns.', Verdict.FAILED, 0.5, 3, observed='nothing', cause='a typo')
NOT_RUN = CheckResult('c', 'It stops.', Verdict.NOT_RUN, 0, 1, waits_for='b')
EXAM = ExamResult('talker', (PASSED, FAILED, NOT_RUN), flags=('odd',), timing={'run_s': 1.5})
PROBLEM = Problem('x.ipynb', 'a notebook', 'a picture', 'submit again', ('talker',))


def through_json(record):
    """Return a result after a round trip through JSON text."""
    return type(record).from_json(json.loads(json.dumps(record.to_json())))


def test_an_exam_result_is_the_same_after_json():
    assert through_json(EXAM) == EXAM
    assert through_json(EXAM).checks[0].verdict is Verdict.PASSED


def test_a_submission_result_is_the_same_after_json():
    result = SubmissionResult('ann', '01', (EXAM,), (PROBLEM,), 'broken')

    assert through_json(result) == result


def test_points_are_sums_over_checks_and_exams():
    result = SubmissionResult('ann', '01', (EXAM, EXAM))

    assert (result.points, result.max_points) == (5.0, 12)
    assert result.flags == ('odd',)


def test_a_problem_is_one_line():
    assert PROBLEM.line() == 'x.ipynb: expected a notebook, got a picture. Try: submit again.'
