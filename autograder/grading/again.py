"""Judge stored recordings again without running a program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from autograder.errors import GraderError, RecordingInvalid
from autograder.exam.exam import Exam
from autograder.grading.examine import judged, without_recording
from autograder.grading.pipeline import Engine
from autograder.layout import Layout
from autograder.recording import Recording
from autograder.results import ExamResult
from autograder.runs.kept import files_digest
from autograder.sandboxes.isolation import MODES


class NothingRuns(Engine):
    """An engine without a sandbox, which provides the exams and refuses to run a program."""

    def exams(self, assignment: str) -> Sequence[Exam]:
        """Return the hidden exams of an assignment in the lesson's order."""
        from autograder.exam import catalog

        return catalog.for_assignment(assignment)

    def run(self, exam: Exam, files: Mapping[str, str]) -> ExamResult:
        """
        Refuse to run a program.

        :raises GraderError: always
        """
        raise GraderError('Judging again runs no program.')


def again(
    layout: Layout, exam: Exam, files: Mapping[str, str], old: ExamResult | None
) -> tuple[ExamResult | None, str]:
    """
    Judge one student's files with one exam, using the stored recording.

    :param old: the last result, which names the recording
    :returns: the result and an empty string, or None and the reason
    """
    mode = old.mode if old else ''
    if mode in MODES and not MODES[mode].keeps_secrets:
        return None, f'only visible checks were run, with isolation {mode}; run grade'
    result = without_recording(exam, files, mode)
    if result is not None:
        return result, ''
    if old is None or not old.recording:
        return None, 'no recording is stored; run grade'
    try:
        recording = Recording.load(layout.recordings / exam.name / old.recording)
    except RecordingInvalid as error:
        return None, f'the recording cannot be read ({error.what}); run grade'
    if recording.header.get('files') != files_digest(files):
        return None, 'the files have changed since the recording; run grade'
    if recording.header.get('scenario') != exam.scenario_digest()[:32]:
        return None, 'the scenario of the exam has changed, not only its checks; run grade'
    return replace(judged(exam, files, recording), recording=old.recording), ''
