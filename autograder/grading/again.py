"""Exams for judging again: recordings are read, nothing runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from autograder.errors import GraderError
from autograder.exam.exam import Exam
from autograder.grading.pipeline import Engine
from autograder.results import ExamResult


class NothingRuns(Engine):
    """The exams without a sandbox: nothing can be run by mistake."""

    def exams(self, assignment: str) -> Sequence[Exam]:
        """Return the full exams of an assignment in the lesson's order."""
        from autograder.exam import catalog

        return catalog.for_assignment(assignment)

    def run(self, exam: Exam, files: Mapping[str, str]) -> ExamResult:
        """Refuse."""
        raise GraderError('Judging again runs no program.')
