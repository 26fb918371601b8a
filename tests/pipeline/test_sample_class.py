"""The bundled class, graded for real: every verdict and its cause are the ones expected."""

from __future__ import annotations

import pytest

from autograder import sample_class
from autograder.inbox import Submission
from autograder.layout import Layout
from autograder.pipeline import grade_class, grading_engine, load_lesson
from autograder.results import Verdict

LAYOUT = Layout.here()
ASSIGNMENT = '07_temperature_monitor'
SAMPLES = list(sample_class.samples(LAYOUT, ASSIGNMENT, everything=True))

pytestmark = [pytest.mark.pipeline, pytest.mark.slow, pytest.mark.ros]


@pytest.fixture(scope='module')
def results(tmp_path_factory):
    """Return the results by name, from one run of the whole class."""
    engine = grading_engine(Layout(tmp_path_factory.mktemp('class')))
    lesson = load_lesson(LAYOUT, ASSIGNMENT, engine)
    class_ = [
        Submission(path.name, path, sample_class.compose(LAYOUT, ASSIGNMENT, path))
        for path in SAMPLES
    ]
    return {one.result.student: one.result for one in grade_class(class_, lesson, engine, jobs=2)}


def test_the_class_is_large_enough():
    """Each kind of outcome is there."""
    names = [path.name for path in SAMPLES]

    assert len(names) >= 12
    assert {name.partition('__')[0] for name in names} == {'pass', 'fail', 'error', 'zero'}


@pytest.mark.parametrize('name', [path.name for path in SAMPLES])
def test_points_and_causes_are_those_expected(results, name):
    """The folder's name says what happens."""
    result = results[name]
    expected = sample_class.expected_of(LAYOUT.sample_class / ASSIGNMENT / name)
    failed = {
        exam.exam: {check.check: check.cause_id for check in exam.failed}
        for exam in result.exams
        if exam.failed
    }

    assert result.fault == ''
    assert failed == expected['failed']
    assert {exam.exam: round(exam.points, 3) for exam in result.exams} == expected['points']
    if name.startswith('pass__'):
        assert result.points == result.max_points
    else:
        assert result.points < result.max_points
        verdicts = [check.verdict for exam in result.exams for check in exam.checks]
        assert Verdict.FAILED in verdicts
