"""An engine without ROS: exams that read the text of the files, so that tests are quick."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from autograder.errors import ProbeFailed
from autograder.layout import Layout
from autograder.results import CheckResult, ExamResult, Verdict

CANARY = 'HIDDEN-INPUT-31.4159'
"""Represents a hidden input, which only the exam may know."""


@dataclass(frozen=True)
class FakeExam:
    """The parts of an exam that the pipeline needs."""

    name: str
    cells: tuple[str, ...]
    max_points: float
    needle: str
    hidden_input: str = CANARY


EXAMS = (
    FakeExam(
        'temperature_message', ('temperature_msg', 'package_xml', 'cmakelists'), 10, 'sensor_id'
    ),
    FakeExam('temperature_publisher', ('temperature_publisher',), 15, "'temperature_topic'"),
    FakeExam('temperature_subscriber', ('temperature_subscriber',), 15, '> THRESHOLD_C'),
    FakeExam('limit_keeper', ('limit_keeper',), 10, '> limit_c'),
)


class FakeEngine:
    """Gives a third of the points for a file, and the rest if it contains the exam's needle."""

    hidden = True

    def exams(self, assignment: str) -> Sequence[FakeExam]:
        """Return the same exams for every assignment."""
        return EXAMS

    def run(self, exam: FakeExam, files: Mapping[str, str]) -> ExamResult:
        """Look for the needle; the text GRADER_FAULT makes the grader fail."""
        text = '\n'.join(files.values())
        if 'GRADER_FAULT' in text:
            raise ProbeFailed('The probe broke off.', 'Grade it again.')
        there = self._check('there', 'Your answer is there', bool(files), exam.max_points / 3)
        right = self._check(
            'right', 'Your answer is right', exam.needle in text, exam.max_points * 2 / 3
        )
        return ExamResult(exam.name, (there, right), mode='fake')

    @staticmethod
    def _check(name: str, title: str, passed: bool, points: float) -> CheckResult:
        if passed:
            return CheckResult(name, title, Verdict.PASSED, points, points)
        return CheckResult(
            name,
            title,
            Verdict.FAILED,
            0,
            points,
            expected='the answer',
            observed='<b>something</b> \x1b[31melse',
            cause=f'{name} failed',
            cause_id=f'not_{name}',
            try_this='try it',
            read='Part 1',
        )


def make(layout: Layout) -> FakeEngine:
    """Return the engine, as ``c.GradeOutside.engine_factory`` expects."""
    return FakeEngine()
