"""Provide exams for judging stored recordings again, without a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from autograder.errors import GraderError
from autograder.exam.exam import Exam
from autograder.grading.pipeline import Engine
from autograder.results import ExamResult


class NothingRuns(Engine):
    """The exams without a sandbox, so that no program can run by mistake."""

    def exams(self, assignment: str) -> Sequence[Exam]:
        """Return the full exams of an assignment in the lesson's order."""
        from autograder.exam import catalog

        return catalog.for_assignment(assignment)

    def run(self, exam: Exam, files: Mapping[str, str]) -> ExamResult:
        """Refuse to run anything."""
        raise GraderError('Judging again runs no program.')
