"""The self-check: full marks for the reference solution, none for the untouched release."""

import json

from collect_sources import laid
from fake_grading import answer, cell, FakeEngine, FakeExam
import pytest

from autograder.authoring.exam_mistakes import self_check
from autograder.layout import Layout

EXAMS = (FakeExam(),)
CHECK = cell('check_talker', "check('talker')", grade=True, points=1)


@pytest.fixture
def said(tmp_path):
    """Return a function that returns what is said about a course with one lesson."""

    def check(solution, release, exams=EXAMS, checks=(CHECK,)):
        for folder, text in (('solutions', solution), ('notebooks', release)):
            notebook = {'cells': [answer(text), *checks], 'metadata': {}, 'nbformat': 4}
            data = json.dumps({**notebook, 'nbformat_minor': 5}).encode()
            laid(tmp_path, {f'{folder}/01_x/x.ipynb': data})
        return list(self_check(Layout(tmp_path), FakeEngine(*exams)))

    return check


def test_reference_and_release_are_as_they_must_be(said):
    assert said('right', '# YOUR CODE HERE') == [
        (True, '01_x: the reference solution has 1 of 1, as expected.'),
        (True, '01_x: the untouched release has 0 of 1, as expected.'),
    ]


def test_reference_that_fails_its_exam_is_reported(said):
    (reference, _) = said('wrong', 'wrong')

    assert reference == (
        False,
        '01_x: the reference solution has 0 of 1, expected 1. talker/c: FAILED',
    )


def test_lesson_without_exams_has_nothing_to_grade(said):
    assert said('right', 'x', (), ()) == [(True, '01_x: nothing to grade, as expected.')]


def test_check_cell_without_an_exam_is_no_lesson_without_exams(said):
    assert said('right', 'x', ()) == [
        (False, '01_x, cell check_talker: this lesson has no exam talker.')
    ]


def test_a_run_without_a_verdict_has_no_points_to_compare(said):
    """A report of 0 of 0 points would suggest that the release is correct."""
    broken = 'has no verdict. exam talker: the probe broke off.'

    assert said('probe', 'probe') == [
        (False, f'01_x: the reference solution {broken}'),
        (False, f'01_x: the untouched release {broken}'),
    ]
