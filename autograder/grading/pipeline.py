"""
Grade one submission, or a class in parallel: read, run, judge, and combine the results.

Threads run programs, on this machine or a cluster, and judge their recordings.  A run takes 2 % of
a processor in this process, because other processes do the work.  If the grader fails on a
submission, that submission is for review, without a score, and grading continues.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
import os
import threading
import time
from typing import TYPE_CHECKING

from autograder.errors import defect, ExamInvalid, GraderError
from autograder.layout import Layout
from autograder.results import ExamResult, SubmissionResult
from autograder.submission.inbox import Submission
from autograder.submission.notebook import Notebook, read_release
from autograder.submission.submission import (
    answer_files,
    ExamFiles,
    extract,
    open_submission,
    Opened,
    with_reasons,
)

if TYPE_CHECKING:
    from autograder.exam.exam import Exam
    from autograder.grading.examine import Engine


Outcome = ExamResult | GraderError
"""The outcome of one exam of one submission: its result, or a grader error."""
THREADS = 'grading'
"""Prefix of the names of the pool's threads."""


def grading_engine(layout: Layout, fresh: bool = False, allow_weak: str = '') -> Engine:
    """
    Return the engine for grading, with the strongest sandbox or an accepted weaker one.

    If the sandbox cannot hide files from programs, the engine uses the visible exams.

    :raises SandboxUnavailable: if no accepted isolation mode works
    """
    from autograder.grading.examine import Engine
    from autograder.sandboxes import choose

    box = choose.strongest(allow_weak) if allow_weak else choose.strongest()
    return Engine(box, layout.recordings, fresh, hidden=box.keeps_secrets)


@dataclass(frozen=True)
class Lesson:
    """The data for grading one assignment: name and content of the release, and the exams."""

    assignment: str
    notebook: str
    release: Notebook
    exams: tuple[Exam, ...]

    def files(self, opened: Opened) -> Mapping[str, ExamFiles]:
        """Return the files of a submission for each exam, by the exam's name."""
        return extract(opened, self.exams, self.release, self.notebook)


@dataclass(frozen=True)
class Graded:
    """A submission with its result and the notebook that was graded."""

    submission: Submission
    opened: Opened
    result: SubmissionResult


def load_lesson(layout: Layout, assignment: str, engine: Engine | None = None) -> Lesson:
    """
    Read the release and the exams of an assignment: the engine's, or else the hidden exams.

    :raises GraderError: if the release or an exam cannot be used
    """
    try:
        path = layout.release(assignment)
        release = read_release(path)
        answer_files(release)
    except (OSError, ValueError) as error:
        raise ExamInvalid(
            f'The release of {assignment} cannot be used: {error}',
            'Try: .venv/bin/autograder release',
        ) from error
    from autograder.exam.catalog import for_assignment

    exams = engine.exams(assignment) if engine else for_assignment(assignment)
    return Lesson(assignment, path.name, release, tuple(exams))


def open_one(submission: Submission, lesson: Lesson) -> Opened:
    """Read one submission and rebuild its notebook from the release and the answers."""
    data, problems = submission.read(lesson.notebook)
    return open_submission(data, lesson.release, lesson.notebook, problems)


def grade_opened(opened: Opened, student: str, lesson: Lesson, engine: Engine) -> SubmissionResult:
    """Grade one submission, running its exams in parallel."""
    files = lesson.files(opened)
    with ThreadPoolExecutor(max_workers=max(1, len(lesson.exams))) as pool:
        outcomes = pool.map(lambda exam: _run(engine, exam, files[exam.name].files), lesson.exams)
    return _assemble(opened, student, lesson, files, list(outcomes))


def grade_class(
    submissions: Sequence[Submission],
    lesson: Lesson,
    engine: Engine,
    jobs: int,
    on_done: Callable[[str, Outcome], None] = lambda student, outcome: None,
    on_graded: Callable[[Graded], None] = lambda graded: None,
) -> tuple[Graded, ...]:
    """
    Grade a class; submissions with equal files share one run.

    :param on_done: called with the student and the outcome after each exam, in any thread
    :param on_graded: called for each graded submission in this thread, while other runs continue
    :returns: the results in the order of the submissions
    """
    opened = [open_one(submission, lesson) for submission in submissions]
    files = [lesson.files(one) for one in opened]
    tasks: dict[tuple[int, str], Future[Outcome]] = {}
    runs: dict[tuple[str, tuple[tuple[str, str], ...]], Future[Outcome]] = {}
    pool = ThreadPoolExecutor(max_workers=max(1, jobs), thread_name_prefix=THREADS)
    try:
        for index, found in enumerate(files):
            for exam in lesson.exams:
                answers = found[exam.name].files
                run = exam.name, tuple(sorted(answers.items()))
                if run not in runs:
                    runs[run] = pool.submit(_run, engine, exam, answers)
                runs[run].add_done_callback(partial(_tell, on_done, submissions[index].student))
                tasks[index, exam.name] = runs[run]
        graded: list[Graded] = []
        for index, submission in enumerate(submissions):
            outcomes = [tasks[index, exam.name].result() for exam in lesson.exams]
            result = _assemble(opened[index], submission.student, lesson, files[index], outcomes)
            graded.append(Graded(submission, opened[index], result))
            on_graded(graded[-1])
    finally:
        # After Ctrl-C, no new run starts; the current runs end at their limits at the latest.
        pool.shutdown(wait=False, cancel_futures=True)
    return tuple(graded)


def _tell(on_done: Callable[[str, Outcome], None], student: str, task: Future[Outcome]) -> None:
    if not task.cancelled() and task.exception() is None:
        on_done(student, task.result())


def _run(engine: Engine, exam: Exam, files: Mapping[str, str]) -> Outcome:
    """Run one exam; return a grader error instead of raising it, so that other exams continue."""
    try:
        return engine.run(exam, files)
    except GraderError as error:
        return error
    except Exception as error:  # a defect in the grader: for review, without a verdict
        return defect(error, exam.name)


def end_runs(within_s: float = 5.0) -> bool:
    """
    End the runs of the pool's threads; return whether all threads have ended in time.

    Exiting is not enough: a sandbox that is still being set up does not end with this process.
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
    Kill the probes and then the sandboxes of this process.

    Probes are killed first, so that none can record that a student's program was killed.  The
    outer process of a sandbox is not killed, because that would orphan the inner one.
    """
    import psutil  # installed only in the course's own Python

    probes: list[psutil.Process] = []
    others: list[psutil.Process] = []
    for process in reversed(psutil.Process().children(recursive=True)):
        with suppress(psutil.Error):
            if process.name() == 'bwrap' and process.ppid() == os.getpid():
                continue
            probing = any(word.endswith('probe/probe.py') for word in process.cmdline())
            (probes if probing else others).append(process)
    for process in (*probes, *others):
        with suppress(psutil.Error):
            process.kill()


def _assemble(
    opened: Opened,
    student: str,
    lesson: Lesson,
    files: Mapping[str, ExamFiles],
    outcomes: Sequence[Outcome],
) -> SubmissionResult:
    """Combine the results of the exams into the result of one submission."""
    done = [outcome for outcome in outcomes if isinstance(outcome, ExamResult)]
    faults = [str(outcome) for outcome in outcomes if isinstance(outcome, GraderError)]
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
