"""
The command ``grade``: grade a class, fill the gradebook and write the reports.

Every run is saved as soon as it ends.  If a grading is stopped at any time, even by a power cut,
the same command continues it.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
import json
from pathlib import Path
import signal
import sys
import time

from rich.console import Console

from autograder.authoring.sample_class import write_sample_class
from autograder.classroom.class_report import write_all_reports
from autograder.classroom.course_lock import alone
from autograder.classroom.not_collected import not_collected
from autograder.classroom.pages import print_table
from autograder.classroom.people import read_people
from autograder.classroom.results_of_class import modes, results_of_others
from autograder.commands import FOR_REVIEW, FRESH, JSON, OK, option, takes, YES
from autograder.commands.progress import progress, Totals
from autograder.errors import GraderError, of_system, UsageError
from autograder.explaining.feedback import printable
from autograder.gradebook.cell_points import refuse_unfit_points
from autograder.gradebook.copies import refuse_damaged
from autograder.gradebook.live_entry import Entering, Guard
from autograder.grading.pipeline import (
    Engine,
    grade_class,
    Graded,
    grading_engine,
    load_lesson,
    SandboxEngine,
)
from autograder.layout import Layout
from autograder.results import first_of, SubmissionResult
from autograder.runs.pool import grading_folder, Pool, processors
from autograder.sandboxes.isolation import banner, not_protected, WEAK
from autograder.submission.inbox import discover, students_in, without_notebooks

AHEAD = 64
"""Runs that a scheduler gets ahead of need, so that workers that join later have work."""
MAX_NAMED = 5


class NotEnteredError(GraderError):
    """Some results could not be entered in the gradebook or written."""

    def __init__(self, what: str, results: Sequence[SubmissionResult]) -> None:
        super().__init__(what)
        self.results = tuple(results)


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
        'number of parallel runs on this machine '
        f'(default: one per processor, here {processors()})',
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
    """Grade a class."""
    # Clusters and services end a job with SIGTERM: clean up as after Ctrl-C.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    _fit_together(chosen)
    layout = Layout.here()
    told = Console(stderr=chosen.json, width=None if sys.stdout.isatty() else 120)
    with alone(layout, 'a grading'):
        submitted = submitted_folder(layout, chosen.submitted, told)
        assignments = _assignments(layout, chosen.assignment)
        with grading_folder(), _engine(layout, chosen, told) as (engine, jobs):
            _refuse_loss(layout, assignments, engine)
            results, trouble = _grade_all(
                layout, assignments, submitted, engine, jobs, told, chosen.yes
            )
    if not results:
        raise _nobody(layout, submitted, assignments)
    if chosen.json:
        print(json.dumps([result.to_json() for result in results]))
    if trouble:
        raise GraderError(trouble)
    return FOR_REVIEW if any(result.review for result in results) else OK


def _fit_together(chosen: argparse.Namespace) -> None:
    """Refuse options that another option would make useless."""
    for name, value, why in (
        ('--allow-weak', chosen.allow_weak, 'never run with weak isolation'),
        ('--jobs', chosen.jobs, 'set the number of runs themselves'),
    ):
        if chosen.cluster and value:
            raise UsageError(
                f'{name} {value}: cannot be used with --cluster, whose workers {why}. '
                f'Try: leave out {name}'
            )


def _grade_all(
    layout: Layout,
    assignments: Sequence[str],
    submitted: Path,
    engine: Engine,
    jobs: int,
    told: Console,
    yes: bool = False,
) -> tuple[list[SubmissionResult], str]:
    """
    Grade each assignment; return all results, and why some were not entered.

    :param yes: whether marks in the gradebook may be lowered or emptied
    """
    guard = Guard(layout, yes)
    results: list[SubmissionResult] = []
    trouble: list[str] = []
    for assignment in assignments:
        try:
            results += _grade_assignment(layout, assignment, submitted, engine, jobs, told, guard)
        except NotEnteredError as error:
            results += error.results
            trouble.append(str(error))
    trouble.append(guard.refusal('everything else was entered'))
    return results, ' '.join(filter(None, dict.fromkeys(trouble)))


def _refuse_loss(layout: Layout, assignments: Sequence[str], engine: Engine) -> None:
    """
    Refuse to grade if marks would be lost, before anything is run.

    :raises GraderError: for a damaged gradebook, or check cells that do not fit their exams
    """
    if _enters(engine):
        refuse_damaged(layout)
        for assignment in assignments:
            refuse_unfit_points(layout, load_lesson(layout, assignment, engine))


def _enters(engine: Engine) -> bool:
    """Return whether results go into the gradebook: visible checks give no grade."""
    return bool(getattr(engine, 'hidden', True))


def _nobody(layout: Layout, submitted: Path, assignments: Sequence[str]) -> UsageError:
    """Return the error about a folder without any submission."""
    known = layout.assignments()
    fix = (
        f'python -m autograder collect {short(submitted, layout)}, if this is a download from '
        'Canvas, Moodle or Gradescope'
    )
    for name in without_notebooks(submitted, known):
        with suppress(OSError):  # not a folder, or not readable
            if students_in(submitted / name, known):
                fix = f'--submitted {short(submitted / name, layout)}'
    return UsageError(
        f'{submitted}: no folder STUDENT/ASSIGNMENT with a notebook, ASSIGNMENT being one of '
        f'{", ".join(assignments)}. Try: {fix}'
    )


@contextmanager
def _engine(
    layout: Layout, chosen: argparse.Namespace, told: Console
) -> Iterator[tuple[Engine, int]]:
    """Yield the engine that runs exams, in a pool or on a cluster, and the number of runs."""
    if chosen.cluster:
        from autograder.grading.cluster import cluster_engine

        with cluster_engine(chosen.cluster, layout, chosen.fresh) as engine:
            assert engine.place is not None
            told.print(f'{engine.place.width} parallel runs on {chosen.cluster}.', highlight=False)
            yield engine, max(engine.place.width, AHEAD)
        return
    engine = grading_engine(layout, chosen.fresh, chosen.allow_weak)
    jobs = warn_if_weak(engine, chosen.jobs or processors(), told)
    with in_a_pool(engine, jobs) as pooled:
        # One thread more than processes: while one thread judges, every process has a run.
        yield pooled, jobs + 1


@contextmanager
def in_a_pool(engine: SandboxEngine, jobs: int) -> Iterator[SandboxEngine]:
    """
    Yield an engine that runs exams in separate processes.

    :param jobs: how many processes
    """
    with Pool(jobs, _say_stopped) as place:
        yield replace(engine, place=place)


def _say_stopped(pid: int) -> None:
    """Print a warning about a worker process that is stopped."""
    print(
        f'worker process {pid} is stopped (SIGSTOP), so its run waits. Try: kill -CONT {pid}',
        file=sys.stderr,
        flush=True,
    )


def warn_if_weak(engine: Engine, jobs: int, told: Console) -> int:
    """Print the banner of a weak mode; return how many runs may be parallel."""
    mode = getattr(getattr(engine, 'sandbox', None), 'mode', '')
    if not not_protected(mode):
        return jobs
    told.print(banner(mode), style='bold red', highlight=False, markup=False)
    return 1


def submitted_folder(layout: Layout, chosen: Path | None, told: Console) -> Path:
    """Return the folder to grade; fill the default folder with the sample class if empty."""
    if chosen is not None:
        if not chosen.is_dir():
            raise UsageError(f'--submitted {chosen}: there is no such folder.')
        return chosen.resolve()
    if not layout.submitted.is_dir() or not any(layout.submitted.iterdir()):
        if layout.reports.is_dir():  # never add sample students to a real class
            raise UsageError(
                f'{layout.submitted}: there is nothing to grade. Try: python -m autograder '
                'collect SOURCE, or python -m autograder sample-class for the example submissions'
            )
        count = write_sample_class(layout, layout.submitted)
        told.print(
            f'autograder/_work/submitted was empty, so the {count} example submissions from '
            'tests/submissions were copied there.',
            highlight=False,
        )
    return layout.submitted


def _assignments(layout: Layout, chosen: str | None) -> tuple[str, ...]:
    known = layout.assignments()
    if not known:
        raise UsageError('notebooks/: there is no assignment. Try: make release')
    return known if chosen is None else (layout.assignment_named(chosen),)


def _grade_assignment(
    layout: Layout,
    assignment: str,
    submitted: Path,
    engine: Engine,
    jobs: int,
    told: Console,
    guard: Guard | None = None,
) -> list[SubmissionResult]:
    """Grade one assignment of a class, enter it, write the reports, print the table."""
    lesson = load_lesson(layout, assignment, engine)
    submissions = discover(submitted, assignment, lesson.notebook, layout.assignments())
    if not submissions:
        return []
    # Read the old results first: if that fails, no runs are wasted.
    others: Sequence[SubmissionResult] = ()
    if submitted.resolve() != layout.submitted.resolve():
        others = results_of_others(layout, assignment, {one.student for one in submissions})
    guard = guard or Guard(layout)
    entering = Entering(layout, lesson, guard)
    began = time.monotonic()
    totals = Totals()
    runs = len(submissions) * len(lesson.exams)
    with progress(runs, assignment, totals=totals) as show:
        graded = grade_class(
            submissions,
            lesson,
            engine,
            jobs,
            show,
            meanwhile=entering.meanwhile if _enters(engine) else lambda ready: None,
        )
    graded_s = time.monotonic() - began
    new, refused = entering.finish(graded) if _enters(engine) else (0, '')
    results = [one.result for one in graded]
    summary = _summary(graded, graded_s, time.monotonic() - began, totals)
    lowered = guard.lowered_in(assignment)
    kept = len(graded) - new - (0 if guard.yes else len(lowered))
    if _enters(engine) and kept:
        summary += f' {kept} were already in the gradebook.'
    if lowered:
        said = 'Fewer points than before' if guard.yes else 'Unchanged in the gradebook'
        summary += f' {said}: {first_of(lowered, MAX_NAMED)}.'
    if folders := without_notebooks(submitted, layout.assignments()):
        some = printable(first_of(folders, MAX_NAMED))
        summary += f' Folders without a notebook of the course were not graded: {some}.'
    if others:
        summary += (
            f' {len(others)} other students are not in this folder; their results are unchanged.'
        )
    unwritten = _report(layout, assignment, results, others, summary, told)
    for line in lowered[MAX_NAMED:] and lowered:
        told.print(f'  {line}', highlight=False, markup=False)
    if trouble := ' '.join(dict.fromkeys(filter(None, (refused, unwritten)))):
        raise NotEnteredError(trouble, results)
    return results


def _report(
    layout: Layout,
    assignment: str,
    results: Sequence[SubmissionResult],
    others: Sequence[SubmissionResult],
    summary: str,
    told: Console,
) -> str:
    """
    Write the reports of all students, and print the table of those graded now.

    :returns: why the reports could not be written, empty if they are
    """
    people = read_people(layout)
    everybody = sorted((*results, *others), key=lambda one: one.student)
    missing = not_collected(layout, assignment, {one.student for one in everybody})
    unwritten = ''
    try:
        index = write_all_reports(layout, assignment, everybody, summary)
        where = f'Reports: {short(index, layout)}'
    except OSError as error:  # the command prints nothing after the table
        unwritten, where = str(of_system(error, str(layout.reports))), ''
    print_table(told, assignment, results, people, missing)
    told.print(summary, highlight=False, markup=False)
    if where:
        told.print(where, highlight=False, soft_wrap=True)
    return unwritten


def _summary(graded: Sequence[Graded], graded_s: float, total_s: float, totals: Totals) -> str:
    reviews = sum(bool(one.result.review) for one in graded)
    some = f'{len(graded)} submission{"s" * (len(graded) != 1)}'
    parts = [f'{some} in {total_s:.1f} s, of which runs took {graded_s:.1f} s']
    slowest = totals.slowest_text()
    if slowest and len(graded) > 1:
        parts.append(printable(slowest))
    if used := modes(one.result for one in graded):
        parts.append(f'isolation {", ".join(used)}')
    if reviews:
        parts.append(f'{reviews} for review')
    return f'{"; ".join(parts)}.'


def short(path: Path, layout: Layout) -> str:
    """Return a path relative to the course."""
    return str(path.relative_to(layout.root)) if path.is_relative_to(layout.root) else str(path)
