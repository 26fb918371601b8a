"""Run one student's files in an exam, or use a stored recording, then judge the recording."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
import json
from pathlib import Path
import time

from autograder.errors import RecordingInvalid, SandboxUnavailable
from autograder.exam import catalog
from autograder.exam.exam import Exam, Run
from autograder.explaining.picture_data import pictures
from autograder.judging.flags import flags_of
from autograder.judging.judge import judge, worth_running
from autograder.recording import Event, header, Recording
from autograder.results import CheckResult, ExamResult, Verdict
from autograder.runs.observe import observe
from autograder.runs.task import parse_outcome, task_of
from autograder.runs.version import digest, environment_digest, files_digest, made_with
from autograder.sandboxes.isolation import MODES, not_protected
from autograder.sandboxes.sandbox import Sandbox


@dataclass(frozen=True)
class Engine:
    """
    Provide the exams of an assignment, and run and judge files; tests use a fast engine.

    A recording depends only on the files, the scenario and the environment.  It is stored under a
    digest of these three, so identical files (such as untouched stubs) run once, grading again
    runs nothing, and an edited check is judged in milliseconds.

    :param sandbox: from :func:`autograder.sandboxes.choose.strongest`, or ``Sandbox('none')`` for
        visible checks
    :param recordings: folder for stored recordings; None to store nothing
    :param fresh: repeat all runs, even if recordings are stored
    :param hidden: whether :meth:`exams` returns the hidden exams instead of the visible ones
    :param remote: runs a task on a worker, see :func:`autograder.runs.task.run_task`; None to run
        programs in the calling thread
    :param on_event: called with each event as it happens; not called for runs on workers
    """

    sandbox: Sandbox
    recordings: Path | None = None
    fresh: bool = False
    hidden: bool = True
    remote: Callable[[bytes], bytes] | None = None
    on_event: Callable[[Event], None] | None = None

    def exams(self, assignment: str) -> Sequence[Exam]:
        """Return the exams of an assignment in the lesson's order."""
        return catalog.for_assignment(assignment, hidden=self.hidden)

    def run(self, exam: Exam, files: Mapping[str, str]) -> ExamResult:
        """
        Run and judge a student's files with an exam.

        :param files: text by relative path; missing files are left out
        :raises GraderError: if the grader failed, so there is no verdict
        """
        if exam.hidden and not self.sandbox.keeps_secrets:
            raise SandboxUnavailable(
                f'A hidden exam never runs with isolation {self.sandbox.mode}, which hides no '
                'files.'
            )
        if result := without_recording(exam, files, self.sandbox.mode):
            return result
        texts = (*files.values(), json.dumps(exam.scenario.to_json()))
        about = {
            'scenario': exam.scenario_digest(),
            'environment': environment_digest(self.sandbox.ros.python, texts),
            'files': files_digest(files),
        }
        parts = (exam.name, self.sandbox.mode, *about.values())
        name = f'{digest(chr(0).join(parts).encode(), 32)}.jsonl'
        path = self.recordings / exam.name / name if self.recordings else None
        result = judge_recording(exam, files, *self._load_or_run(exam, files, about, path))
        return replace(result, recording=name if path else '')

    def _load_or_run(
        self, exam: Exam, files: Mapping[str, str], about: Mapping[str, str], path: Path | None
    ) -> tuple[Recording, dict[str, float]]:
        """
        Return the stored recording, or run the files and store the recording.

        :param about: the digests for the header of a new recording
        :param path: file of the stored recording; None to store nothing
        :returns: the recording, and times of the run [s], which are empty for a stored recording
        """
        if path and path.exists() and not self.fresh:
            with suppress(RecordingInvalid):  # a damaged file or an older format: record again
                return Recording.load(path), {}
        scenario = exam.scenario.to_json()
        if self.remote is None:
            made, timing = observe(exam.name, scenario, files, self.sandbox, self.on_event)
        else:
            task = task_of(exam.name, scenario, files, self.sandbox.mode)
            made, timing = parse_outcome(self.remote(task))
        notes = {'made_with': dict(made_with()), 'run_s': timing['run_s']}
        recording = replace(made, header={**made.header, **about, **notes})
        if path:
            recording.save(path)
        return recording, timing


def judge_again(
    recordings: Path, exam: Exam, files: Mapping[str, str], old: ExamResult | None
) -> tuple[ExamResult | None, str]:
    """
    Judge one student's files again from the stored recording, without running a program.

    :param recordings: folder in which recordings are stored
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
        recording = Recording.load(recordings / exam.name / old.recording)
    except RecordingInvalid as error:
        return None, f'the recording cannot be read ({error.what}); run grade'
    if recording.header.get('files') != files_digest(files):
        return None, 'the files have changed since the recording; run grade'
    if recording.header.get('scenario') != exam.scenario_digest():
        return None, 'the scenario of the exam has changed, not only its checks; run grade'
    return replace(judge_recording(exam, files, recording), recording=old.recording), ''


def judge_recording(
    exam: Exam,
    files: Mapping[str, str],
    recording: Recording,
    timing: Mapping[str, float] | None = None,
) -> ExamResult:
    """
    Judge a student's files from their recording, without running a program.

    :param timing: times of the run [s]; None for a stored recording
    :raises GraderError: if a check raises an exception
    """
    began = time.perf_counter()
    run = Run(files, recording, exam.facts)
    checks = judge(exam, run)
    known = recording.header
    if not timing:
        timing = {'kept_run_s': known['run_s']} if 'run_s' in known else {}
    mode = str(known.get('mode', ''))
    return ExamResult(
        exam.name,
        checks,
        '',
        mode,
        flags_of(recording, exam.scenario),
        {**timing, 'judge_s': time.perf_counter() - began},
        not_protected=not_protected(mode),
        pictures=pictures(exam, run, checks),
    )


def without_recording(exam: Exam, files: Mapping[str, str], mode: str) -> ExamResult | None:
    """
    Judge files without a run if a file is missing or the files alone decide the verdicts.

    :param mode: isolation mode that the result names
    :returns: the result, or None if a run is needed
    """
    missing = [name for name in exam.requires if name not in files]
    if missing:
        return _without(exam, missing)
    if worth_running(exam, files):
        return None
    return judge_recording(exam, files, Recording(header(exam.name, mode), ()))


def _without(exam: Exam, missing: list[str]) -> ExamResult:
    """Return the result for a missing file: the first check fails, and the others wait for it."""
    first, *waiting = (
        CheckResult(
            check.name,
            check.title,
            Verdict.NOT_RUN,
            0.0,
            check.points,
            read=exam.read,
            waits_for=exam.checks[0].name,
        )
        for check in exam.checks
    )
    failed = replace(
        first,
        verdict=Verdict.FAILED,
        expected=f'the file{"s" if len(missing) > 1 else ""} {", ".join(missing)}',
        observed='no such cell in the notebook',
        cause='The cell is missing or empty, or its first line is not the magic line.',
        cause_id='missing_file',
        try_this='Put the cell back as it was released and write your answer in it.',
        waits_for='',
    )
    return ExamResult(exam.name, (failed, *waiting), note='Nothing was run: a file is missing.')
