"""
The command ``grade``: grade a class, fill the gradebook and write the reports.

Each recording is saved as soon as its run ends.  If grading is interrupted, even by a power
cut, the same command resumes it.
"""

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
import json
import os
from pathlib import Path
import signal
import sys
import time

from rich.console import Console

from autograder.authoring.sample_class import write_sample_class
from autograder.classroom.course_lock import lock_course
from autograder.classroom.pages import print_table, write_all_reports
from autograder.classroom.people import extensions, not_listed, read_people
from autograder.classroom.results_of_class import last_results, modes, results_of_others
from autograder.classroom.standing import (
    absent,
    collected_digests,
    MISSING,
    without_result,
)
from autograder.commands import flag, FOR_REVIEW, FRESH, JSON, OK, option, takes, YES
from autograder.commands.progress import progress, run_s, slowest_text
from autograder.errors import from_os_error, GraderError, UsageError
from autograder.exam.inputs import keep_secret, refuse_other_secret
from autograder.explaining.feedback import printable
from autograder.exports.as_json import submission_json
from autograder.gradebook.database import (
    notes_for_instructor,
    refuse_damaged,
    to_grade_by_hand,
)
from autograder.gradebook.live_entry import Guard, LiveEntry, MAX_NAMED
from autograder.gradebook.record import refuse_unfit_points
from autograder.grading.examine import Engine
from autograder.grading.pipeline import grade_class, grading_engine, load_lesson
from autograder.layout import Layout
from autograder.results import first_of, SubmissionResult
from autograder.runs.grading_folder import grading_folder
from autograder.sandboxes.isolation import banner, not_protected, WEAK
from autograder.submission.inbox import discover, students_in, without_notebooks

AHEAD = 64
"""Minimum number of runs queued on a cluster, so that workers that join later have work."""
PROCESSORS = len(os.sched_getaffinity(0))
"""Number of processors that this process may use."""


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'expected a whole number of at least 1, got {text!r}')
    return int(text)


@takes(
    option(
        '--submitted',
        'folder with STUDENT/ASSIGNMENT/NOTEBOOK.ipynb (default: autograder/_work/submitted); '
        'students who are only in the default folder keep their results and pages',
        type=Path,
        metavar='DIR',
    ),
    option('--assignment', 'grade only this assignment (default: all)', metavar='NAME'),
    option(
        '--jobs',
        f'number of parallel runs on this machine (default: one per processor, here {PROCESSORS})',
        type=_positive,
        default=0,
        metavar='N',
    ),
    option(
        '--cluster',
        'run on the workers of a Dask scheduler, such as tcp://10.0.0.5:8786 '
        '(see docs/cluster.md)',
        default='',
        metavar='ADDRESS',
    ),
    FRESH,
    JSON,
    YES,
    flag(
        '--allow-review',
        'exit with code 0 even if some submissions are for review, as make grade does',
    ),
    option(
        '--allow-weak',
        'accept this weaker isolation if no stronger one works here: '
        f'{", ".join(WEAK)} (see docs/threat-model.md)',
        choices=WEAK,
        default='',
        metavar='MODE',
    ),
)
def run(chosen: argparse.Namespace) -> int:
    """Grade a class and print the results."""
    # Cluster and service managers end a job with SIGTERM: clean up as after Ctrl-C.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    _refuse_ineffective_options(chosen)
    layout = Layout.here()
    console = Console(
        stderr=chosen.json, width=None if sys.stdout.isatty() else 120, highlight=False
    )
    with lock_course(layout, 'grade'):
        submitted = submitted_folder(layout, chosen.submitted, console)
        assignments = _assignments(layout, chosen.assignment)
        with grading_folder(), _engine(layout, chosen, console) as (engine, jobs):
            grading = Grading(layout, submitted, engine, jobs, console, Guard(layout, chosen.yes))
            grading.refuse_loss(assignments)
            results, trouble = grading.all(assignments)
    if not results:
        raise _no_submissions(layout, submitted, assignments)
    if chosen.json:
        print(json.dumps([submission_json(result) for result in results]))
    with suppress(GraderError):  # The trouble below says why the gradebook cannot be read.
        for line in notes_for_instructor(layout):
            console.print(printable(line), markup=False, soft_wrap=True)
    if trouble:
        raise GraderError(trouble)
    reviews = sum(bool(result.review) for result in results)
    if not reviews or chosen.allow_review:
        return OK
    said = 'submission is' if reviews == 1 else 'submissions are'
    console.print(f'Exit code {FOR_REVIEW}: {reviews} {said} for review.')
    return FOR_REVIEW


def _refuse_ineffective_options(chosen: argparse.Namespace) -> None:
    """Refuse options that have no effect together with ``--cluster``."""
    for name, value, why in (
        ('--allow-weak', chosen.allow_weak, 'never run with weak isolation'),
        ('--jobs', chosen.jobs, 'set the number of runs themselves'),
    ):
        if chosen.cluster and value:
            raise UsageError(
                f'{name} {value}: cannot be used with --cluster, whose workers {why}. '
                f'Try: leave out {name}'
            )


def _no_submissions(layout: Layout, submitted: Path, assignments: Sequence[str]) -> UsageError:
    """Return the error for a folder without submissions."""
    known = layout.assignments()
    fix = (
        f'.venv/bin/autograder collect {relative_path(submitted, layout)}, if this is a '
        'download from Canvas, Moodle or Gradescope'
    )
    for name in without_notebooks(submitted, known):
        with suppress(OSError):  # The entry may be a file or unreadable.
            if students_in(submitted / name, known):
                fix = f'--submitted {relative_path(submitted / name, layout)}'
    return UsageError(
        f'{submitted}: no folder STUDENT/ASSIGNMENT with a notebook; ASSIGNMENT is one of '
        f'{", ".join(assignments)}. Try: {fix}'
    )


@contextmanager
def _engine(
    layout: Layout, chosen: argparse.Namespace, console: Console
) -> Iterator[tuple[Engine, int]]:
    """Yield the engine that runs exams here or on a cluster, and the number of parallel runs."""
    if chosen.cluster:
        from autograder.grading.cluster import cluster_engine

        with cluster_engine(chosen.cluster, layout, chosen.fresh) as (engine, width):
            console.print(f'{width} parallel runs on {chosen.cluster}.')
            yield engine, max(width, AHEAD)
        return
    engine = grading_engine(layout, chosen.fresh, chosen.allow_weak)
    yield engine, warn_if_weak(engine, chosen.jobs or PROCESSORS, console)


def warn_if_weak(engine: Engine, jobs: int, console: Console) -> int:
    """Return the number of parallel runs; if isolation is weak, print a warning and return 1."""
    if not not_protected(engine.sandbox.mode):
        return jobs
    console.print(banner(engine.sandbox.mode), style='bold red', markup=False)
    return 1


def submitted_folder(layout: Layout, chosen: Path | None, console: Console) -> Path:
    """Return the folder to grade; in a new course, first fill it with the sample class."""
    if chosen is not None:
        if not chosen.is_dir():
            raise UsageError(f'--submitted {chosen}: there is no such folder.')
        return chosen.resolve()
    if not layout.submitted.is_dir() or not any(layout.submitted.iterdir()):
        if layout.reports.is_dir():  # Never add sample students to a real class.
            raise UsageError(
                f'{layout.submitted}: there is nothing to grade. Try: .venv/bin/autograder '
                'collect SOURCE, or .venv/bin/autograder sample-class for the example submissions'
            )
        count = write_sample_class(layout, layout.submitted)
        console.print(
            f'autograder/_work/submitted was empty, so the {count} example submissions from '
            'tests/submissions were copied there.'
        )
    return layout.submitted


def _assignments(layout: Layout, chosen: str | None) -> tuple[str, ...]:
    known = layout.assignments()
    if not known:
        raise UsageError('notebooks/ contains no assignments. Try: .venv/bin/autograder release')
    return known if chosen is None else (layout.assignment_named(chosen),)


@dataclass
class Grading:
    """
    Grade the assignments of one class, enter the results, write the reports and print tables.

    :param engine: provides and runs the exams; if they are the visible ones, nothing is entered in
        the gradebook
    :param guard: decides which marks in the gradebook may change
    """

    layout: Layout
    submitted: Path
    engine: Engine
    jobs: int
    console: Console
    guard: Guard

    def refuse_loss(self, assignments: Sequence[str]) -> None:
        """
        Refuse to grade if marks would be lost; call this before any run.

        :raises GraderError: if the gradebook is damaged, the course secret has changed, or a check
            cell and its exam give different points
        """
        read_people(self.layout)  # Report wrong files here, not after the runs.
        extensions(self.layout)
        if self.engine.hidden:
            refuse_other_secret(self.layout)
            refuse_damaged(self.layout)
            for assignment in assignments:
                lesson = load_lesson(self.layout, assignment, self.engine)
                refuse_unfit_points(self.layout, lesson)

    def all(self, assignments: Sequence[str]) -> tuple[list[SubmissionResult], str]:
        """Grade each assignment; return all results, and why some were not entered, else empty."""
        results: list[SubmissionResult] = []
        trouble: list[str] = []
        for assignment in assignments:
            found, why = self.one(assignment)
            results += found
            trouble.append(why)
        trouble.append(self.guard.refusal('everything else was entered'))
        return results, ' '.join(filter(None, dict.fromkeys(trouble)))

    def one(self, assignment: str) -> tuple[list[SubmissionResult], str]:
        """Grade one assignment; return the results, and why some were not entered or written."""
        layout, lesson = self.layout, load_lesson(self.layout, assignment, self.engine)
        class_ = discover(self.submitted, assignment, lesson.notebook, layout.assignments())
        if not class_:
            return [], ''
        if self.engine.hidden:
            keep_secret(layout)
        # Read the old results before any run: if they are damaged, no run is wasted.
        others: Sequence[SubmissionResult] = ()
        if self.submitted.resolve() != layout.submitted.resolve():
            others = results_of_others(layout, assignment, {one.student for one in class_})
        before: Sequence[SubmissionResult] = ()
        with suppress(GraderError):  # Damaged results are replaced.
            before = last_results(layout, assignment)
        # Read before the runs: work that changes during the grading counts as changed.
        collected = collected_digests(layout, assignment)
        entry = LiveEntry(layout, lesson, self.guard)
        enter = entry.add if self.engine.hidden else lambda graded: None
        began = time.monotonic()
        with progress(len(class_) * len(lesson.exams), assignment) as show:
            graded = grade_class(class_, lesson, self.engine, self.jobs, show, enter)
        runs_s = time.monotonic() - began
        _, refused = entry.finish()
        results = [
            replace(one.result, collected=collected.get(one.result.student, '')) for one in graded
        ]
        lowered = self.guard.lowered_in(assignment)
        about_marks = [] if refused or not self.engine.hidden else [entry.counts(graded)]
        parts = [
            about_runs(results, time.monotonic() - began, runs_s),
            *about_marks,
            *self._about_lowered(lowered),
            *self._about_others(results, others),
        ]
        shown = [
            one for one in results if one.review or one not in before or not self.engine.hidden
        ]
        unwritten = self._report(assignment, (*results, *others), shown, ' '.join(parts))
        for line in lowered if len(lowered) > MAX_NAMED else ():
            self.console.print(f'  {line}', markup=False)
        return results, ' '.join(dict.fromkeys(filter(None, (refused, unwritten))))

    def _about_lowered(self, lowered: Sequence[str]) -> Iterator[str]:
        """Yield a sentence about marks that are, or would be, lowered."""
        if lowered:
            said = 'Fewer points than before' if self.guard.yes else 'Not lowered in the gradebook'
            yield f'{said}: {first_of(lowered, MAX_NAMED)}.'

    def _about_others(
        self, results: Sequence[SubmissionResult], others: Sequence[SubmissionResult]
    ) -> Iterator[str]:
        """Yield sentences about ungraded work and about students not on the class list."""
        folders = without_notebooks(self.submitted, self.layout.assignments())
        for said, names in (
            ('Not on the class list', not_listed(self.layout, [one.student for one in results])),
            ('Folders without a notebook of the course were not graded', folders),
        ):
            if names:
                yield f'{said}: {printable(first_of(names, MAX_NAMED))}.'
        if others:
            yield f'Students not in this folder: {len(others)}. Their results are unchanged.'

    def _report(
        self,
        assignment: str,
        everybody: Sequence[SubmissionResult],
        shown: Sequence[SubmissionResult],
        summary: str,
    ) -> str:
        """Write the reports, print some of the results; return why reports are missing."""
        layout, console = self.layout, self.console
        everybody = sorted(everybody, key=lambda one: one.student)
        missing = without_result(layout, assignment, everybody)
        by_hand = to_grade_by_hand(layout, assignment, everybody)
        unwritten = where = ''
        try:
            where = relative_path(
                write_all_reports(layout, assignment, everybody, summary, len(by_hand)), layout
            )
        except OSError as error:  # Print the table first, then report the error.
            unwritten = str(from_os_error(error, str(layout.reports)))
        refused = [one for one in missing if one.status != MISSING]
        if shown or refused:
            some = ' (new, changed or for review)' if len(shown) < len(everybody) else ''
            print_table(console, assignment + some, shown, read_people(layout), refused)
            console.print(summary, markup=False)
        else:
            console.print(f'{assignment}: {summary}', markup=False)
        if names := [one.person or one.student for one in absent(missing)]:
            said = f'Nothing to grade yet from: {first_of(names, MAX_NAMED)}.'
            console.print(printable(said), markup=False)
        if where:
            console.print(f'Reports: {where}', soft_wrap=True)
        return unwritten


def about_runs(results: Sequence[SubmissionResult], total_s: float, runs_s: float) -> str:
    """Return a sentence with duration, isolation modes and number of submissions for review."""
    some = f'{len(results)} submission{"s" * (len(results) != 1)}'
    facts = [f'{some} in {total_s:.1f} s, of which runs took {runs_s:.1f} s']
    slowest = slowest_text({one.student: sum(map(run_s, one.exams)) for one in results})
    if len(results) > 1:
        facts.append(slowest or 'no program had to run')
    if used := modes(results):
        facts.append(f'isolation {", ".join(used)}')
    if reviews := sum(bool(one.review) for one in results):
        facts.append(f'{reviews} for review')
    return f'{"; ".join(facts)}.'


def relative_path(path: Path, layout: Layout) -> str:
    """Return a path relative to the course; unchanged if it is outside the course."""
    return str(path.relative_to(layout.root)) if path.is_relative_to(layout.root) else str(path)
