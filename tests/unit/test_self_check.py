"""The self-check: full marks for the reference solution, none for the untouched release."""

from dataclasses import dataclass
import json
from pathlib import Path

import pytest

from autograder.authoring.self_check import self_check
from autograder.errors import ProbeFailed
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, Verdict


@dataclass(frozen=True)
class FakeExam:
    """The parts of an exam that the pipeline needs."""

    name: str = 'talker'
    cells: tuple[str, ...] = ('talker',)


class FakeEngine:
    """Gives a point for the word "right"."""

    def __init__(self, *exams: FakeExam) -> None:
        self.known = exams

    def exams(self, assignment):
        """Return the same exams for every assignment."""
        return self.known

    def run(self, exam, files):
        """Return one point if an answer contains the word."""
        points = float('right' in ''.join(files.values()))
        verdict = Verdict.PASSED if points else Verdict.FAILED
        return ExamResult(exam.name, (CheckResult('c', 'C.', verdict, points, 1),))


def cell(source: str, **marks: object) -> dict[str, object]:
    metadata = {'nbgrader': marks} if marks else {}
    return {'cell_type': 'code', 'metadata': metadata, 'source': source, 'id': 'x', 'outputs': []}


@pytest.fixture
def course(tmp_path: Path):
    """Return a function that writes a course with one lesson."""

    def write(solution: str, release: str, checked: bool = True) -> Layout:
        for folder, text in (('solutions', solution), ('notebooks', release)):
            cells = [cell(f'%%node talker\n{text}', grade_id='talker', solution=True)]
            if checked:
                marks = {'grade_id': 'check_talker', 'grade': True, 'points': 1}
                cells.append(cell("check('talker')", **marks))
            notebook = {'cells': cells, 'metadata': {}, 'nbformat': 4, 'nbformat_minor': 5}
            path = tmp_path / folder / '01_x' / 'x.ipynb'
            path.parent.mkdir(parents=True)
            path.write_text(json.dumps(notebook), encoding='utf-8')
        return Layout(tmp_path)

    return write


def test_reference_and_release_are_as_they_must_be(course):
    layout = course('right', '# YOUR CODE HERE')

    lines = list(self_check(layout, FakeEngine(FakeExam())))

    assert lines == [
        (True, '01_x: the reference solution has 1 of 1, as expected.'),
        (True, '01_x: the untouched release has 0 of 1, as expected.'),
    ]


def test_reference_that_fails_its_exam_is_reported(course):
    (reference, _) = self_check(course('wrong', 'wrong'), FakeEngine(FakeExam()))

    assert reference == (
        False,
        '01_x: the reference solution has 0 of 1, expected 1. talker/c: FAILED',
    )


def test_lesson_without_exams_has_nothing_to_grade(course):
    lines = list(self_check(course('right', 'x', checked=False), FakeEngine()))

    assert lines == [(True, '01_x: nothing to grade, as expected.')]


def test_check_cell_without_an_exam_is_no_lesson_without_exams(course):
    lines = list(self_check(course('right', 'x'), FakeEngine()))

    assert lines == [(False, '01_x, cell check_talker: this lesson has no exam talker.')]


def test_a_run_without_a_verdict_has_no_points_to_compare(course):
    """A report of 0 of 0 points would suggest that the release is correct."""

    class BrokenEngine(FakeEngine):
        """Fails because its probe stops early."""

        def run(self, exam, files):
            raise ProbeFailed(f'exam {exam.name}: the probe broke off.')

    lines = list(self_check(course('right', 'x'), BrokenEngine(FakeExam())))

    said = 'has no verdict. exam talker: the probe broke off.'
    assert lines == [
        (False, f'01_x: the reference solution {said}'),
        (False, f'01_x: the untouched release {said}'),
    ]
