"""
Grade one submission, or a class in parallel: read, run, judge, put results together.

Threads run programs, here or on a cluster, and judge their recordings.  A run needs 2 % of a
processor here: its work is in other processes.  A fault of the grader makes one submission "for
review"; it never gives zero points and never stops the others.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
import os
from pathlib import Path
import threading
import time
from typing import Protocol, TYPE_CHECKING

from autograder.errors import defect, ExamInvalid, GraderError
from autograder.layout import Layout
from autograder.results import ExamResult, SubmissionResult
from autograder.submission.extract import answer_files, ExamFiles, extract, with_reasons
from autograder.submission.inbox import Submission
from autograder.submission.notebook import Notebook, read_release
from autograder.submission.submission import open_submission, Opened

if TYPE_CHECKING:
    from autograder.exam.exam import Exam
    from autograder.runs.task import Place
    from autograder.sandboxes.sandbox import Sandbox


THREADS = 'grading'
"""How the names of the pool's threads begin."""


class Engine(Protocol):
    """A source of exams that can run them; tests use a quick one."""

    def exams(self, assignment: str) -> Sequence[Exam]:
        """Return the exams of an assignment in the lesson's order."""

    def run(self, exam: Exam, files: Mapping[str, str]) -> ExamResult:
        """
        Judge files by what they do.

        :raises GraderError: if there is no verdict, through no fault of the files
        """


@dataclass(frozen=True)
class SandboxEngine:
    """
    The real engine: hidden and visible exams, with student code in a sandbox.

    :param recordings: folder of recordings; an identical run is read, not repeated
    :param fresh: repeat all runs
    :param hidden: whether the hidden checks are part of it
    :param place: where runs take place, None for the calling thread
    """

    sandbox: Sandbox
    recordings: Path | None = None
    fresh: bool = False
    hidden: bool = True
    place: Place | None = None

    def exams(self, assignment: str) -> Sequence[Exam]:
        """Return the exams of an assignment in the lesson's order."""
        from autograder.exam import catalog

        return catalog.for_assignment(assignment, hidden=self.hidden)

    def run(self, exam: Exam, files: Mapping[str, str]) -> ExamResult:
        """Run the files in the sandbox and judge the recording."""
        from autograder.grading.examine import examine

        return examine(
            exam,
            files,
            sandbox=self.sandbox,
            recordings=self.recordings,
            fresh=self.fresh,
            place=self.place,
        )


def grading_engine(layout: Layout, fresh: bool = False, allow_weak: str = '') -> SandboxEngine:
    """
    Return the engine for grades, with the strongest sandbox or an accepted weaker one.

    With a sandbox that hides nothing, the visible exams run instead of the hidden ones.

    :param allow_weak: see :func:`autograder.sandboxes.choose.strongest`
    :raises SandboxUnavailable: if no isolation works that may run hidden exams
    """
    from autograder.sandboxes import choose

    box = choose.strongest(allow_weak) if allow_weak else choose.strongest()
    return SandboxEngine(box, layout.recordings, fresh, hidden=box.keeps_secrets)


@dataclass(frozen=True)
class Lesson:
    """
    Everything that is needed to grade one assignment.

    :param notebook: file name of the released notebook
    :param release: its content
    """

    assignment: str
    notebook: str
    release: Notebook
    exams: tuple[Exam, ...]

    def files(self, opened: Opened) -> Mapping[str, ExamFiles]:
        """Return the files of a submission that each exam gets, by the name of the exam."""
        return extract(opened, self.exams, self.release, self.notebook)


@dataclass(frozen=True)
class Graded:
    """A submission with its result and the notebook that was graded."""

    submission: Submission
    opened: Opened
    result: SubmissionResult


def load_lesson(layout: Layout, assignment: str, engine: Engine) -> Lesson:
    """
    Read the release and the exams of an assignment.

    :raises GraderError: if the course itself is incomplete
    """
    try:
        path = layout.release(assignment)
        release = read_release(path)
        answer_files(release)
    except (OSError, ValueError) as error:
        raise ExamInvalid(
            f'The release of {assignment} cannot be used: {error}',
            'Try: make release',
        ) from error
    return Lesson(assignment, path.name, release, tuple(engine.exams(assignment)))


def open_one(submission: Submission, lesson: Lesson) -> Opened:
    """Read one submission; keep only the answers."""
    data, problems = submission.read(lesson.notebook)
    return open_submission(data, lesson.release, lesson.notebook, problems)


def grade_opened(opened: Opened, student: str, lesson: Lesson, engine: Engine) -> SubmissionResult:
    """Grade one submission, with its exams in parallel."""
    files = lesson.files(opened)
    with ThreadPoolExecutor(max_workers=max(1, len(lesson.exams))) as pool:
        tasks = {
            exam.name: pool.submit(_run, engine, exam, files[exam.name].files)
            for exam in lesson.exams
        }
    outcomes = {name: task.result() for name, task in tasks.items()}
    return _assemble(opened, student, lesson, files, outcomes)


def grade_notebook(
    data: bytes | None, lesson: Lesson, student: str, engine: Engine
) -> SubmissionResult:
    """
    Grade the bytes of one notebook.

    :param data: content of the file, None if there is none
    """
    opened = open_submission(data, lesson.release, lesson.notebook)
    return grade_opened(opened, student, lesson, engine)


def grade_class(
    submissions: Sequence[Submission],
    lesson: Lesson,
    engine: Engine,
    jobs: int,
    on_done: Callable[[Done], None] = lambda done: None,
    on_graded: Callable[[Graded], None] = lambda graded: None,
) -> tuple[Graded, ...]:
    """
    Grade a class; equal files run once.

    :param jobs: how many runs at a time
    :param on_done: called for each exam of each submission, in any thread
    :param on_graded: called for each submission in this thread, while the pool runs others
    :returns: in the order of the submissions
    """
    opened = [open_one(submission, lesson) for submission in submissions]
    files = [lesson.files(one) for one in opened]
    tasks: dict[tuple[int, str], Future[ExamResult | GraderError]] = {}
    runs: dict[tuple[str, tuple[tuple[str, str], ...]], Future[ExamResult | GraderError]] = {}
    pool = ThreadPoolExecutor(max_workers=max(1, jobs), thread_name_prefix=THREADS)
    try:
        for index, found in enumerate(files):
            for exam in lesson.exams:
                answers = found[exam.name].files
                run = exam.name, tuple(sorted(answers.items()))
                if run not in runs:
                    runs[run] = pool.submit(_run, engine, exam, answers)
                tell = partial(_tell, on_done, submissions[index].student, exam.name)
                runs[run].add_done_callback(tell)
                tasks[index, exam.name] = runs[run]
        graded: list[Graded] = []
        for index, submission in enumerate(submissions):
            parts = {exam.name: tasks[index, exam.name] for exam in lesson.exams}
            outcomes = {name: part.result() for name, part in parts.items()}
            result = _assemble(opened[index], submission.student, lesson, files[index], outcomes)
            graded.append(Graded(submission, opened[index], result))
            on_graded(graded[-1])
    finally:
        # After Ctrl-C nothing new starts; the limits of the sandboxes end the current runs.
        pool.shutdown(wait=False, cancel_futures=True)
    return tuple(graded)


def _tell(
    on_done: Callable[[Done], None],
    student: str,
    exam: str,
    task: Future[ExamResult | GraderError],
) -> None:
    if not task.cancelled() and task.exception() is None:
        on_done(Done(student, exam, task.result()))


def _run(engine: Engine, exam: Exam, files: Mapping[str, str]) -> ExamResult | GraderError:
    """Run one exam; return a fault of the grader as a value, so that the others continue."""
    try:
        return engine.run(exam, files)
    except GraderError as error:
        return error
    except Exception as error:  # a defect of the grader: for review, without a verdict
        return defect(error, exam.name)


def end_runs(within_s: float = 5.0) -> bool:
    """
    End the runs of the pool's threads, so that the threads clean up and end.

    Dying with the runs is not enough: a sandbox that is just being set up is not yet tied to
    this process.

    :param within_s: how long to try
    :returns: whether the threads have ended
    """
    deadline = time.monotonic() + within_s
    while threads := [one for one in threading.enumerate() if one.name.startswith(THREADS)]:
        _end_sandboxes()
        threads[0].join(0.05)
        if time.monotonic() > deadline:
            return False
    return True


def _end_sandboxes() -> None:
    """
    End the sandboxes and probes of this process in the right order.

    Probes come first: no probe may record that a student's program was killed.  The outer process
    of a sandbox is not killed, because that would orphan the inner one.
    """
    import psutil  # installed only in the course's own Python

    probes: list[psutil.Process] = []
    others: list[psutil.Process] = []
    for process in reversed(psutil.Process().children(recursive=True)):
        with suppress(psutil.Error):
            if process.name() == 'bwrap' and process.ppid() == os.getpid():
                continue
            probing = any(word.endswith('fork_server.py') for word in process.cmdline())
            (probes if probing else others).append(process)
    for process in (*probes, *others):
        with suppress(psutil.Error):
            process.kill()


def _assemble(
    opened: Opened,
    student: str,
    lesson: Lesson,
    files: Mapping[str, ExamFiles],
    outcomes: Mapping[str, ExamResult | GraderError],
) -> SubmissionResult:
    """Put the result of one submission together."""
    done = [outcome for outcome in outcomes.values() if isinstance(outcome, ExamResult)]
    faults = [str(outcome) for outcome in outcomes.values() if isinstance(outcome, GraderError)]
    problems = [*opened.problems]
    for exam in lesson.exams:
        problems += files[exam.name].problems
    result = SubmissionResult(
        student=student,
        assignment=lesson.assignment,
        exams=tuple(done),
        problems=tuple(problems),
        fault=' '.join(dict.fromkeys(faults)),
        noticed=opened.flags,
    )
    return with_reasons(result, lesson.exams)


@dataclass(frozen=True)
class Done:
    """
    One exam of one submission has ended.

    :param student: whose it is
    :param outcome: the result, or a fault of the grader
    """

    student: str
    exam: str
    outcome: ExamResult | GraderError
