"""
The command ``grade``: a class from its folder to the gradebook and the reports.

Every run is kept the moment it is done, so that a grading that was ended, whoever ended it and
when, is continued by the same command.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
import json
from pathlib import Path
import signal
import sys
import time
from typing import TYPE_CHECKING

from autograder.errors import GraderError
from autograder.explaining.feedback import printable
from autograder.layout import Layout
from autograder.progress import Done, progress, Totals
from autograder.runs.workers import grading_folder, Pool, processors
from autograder.sandboxes.isolation import banner, not_protected, WEAK
from autograder.whole_class.alone import alone

if TYPE_CHECKING:
    from rich.console import Console

    from autograder.judging.results import SubmissionResult
    from autograder.whole_class.inbox import Submission
    from autograder.whole_class.pipeline import Engine, Graded, Lesson, SandboxEngine

OK, FOR_REVIEW = 0, 1
AHEAD = 64
"""Runs that a scheduler has before it needs them: workers that come later find something to do."""
MOST_NAMED = 5


class UsageError(Exception):
    """The command line asks for something that is not there."""


class NotEnteredError(GraderError):
    """The results are there, but nbgrader's gradebook refused some of them."""

    def __init__(self, what: str, results: Sequence[SubmissionResult]) -> None:
        """Keep the results, which are reported all the same."""
        super().__init__(what)
        self.results = tuple(results)


def add_grade(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """
    Describe the command.

    :param commands: what :meth:`argparse.ArgumentParser.add_subparsers` returns
    """
    grade = commands.add_parser('grade', help='grade a class and write reports')
    grade.add_argument(
        '--submitted',
        type=Path,
        metavar='DIR',
        help='folder of STUDENT/ASSIGNMENT/NOTEBOOK.ipynb (default: autograder/_work/submitted); '
        'students who are only in the default one keep their results and pages',
    )
    grade.add_argument('--assignment', metavar='NAME', help='only this one (default: all)')
    grade.add_argument(
        '--jobs',
        type=_positive,
        default=0,
        metavar='N',
        help=f'runs at a time on this machine (default: one a processor, here {processors()})',
    )
    grade.add_argument(
        '--cluster',
        default='',
        metavar='ADDRESS',
        help='run on the workers of a Dask scheduler, such as tcp://10.0.0.5:8786 '
        '(see docs/cluster.md)',
    )
    grade.add_argument('--fresh', action='store_true', help='repeat runs that are recorded')
    grade.add_argument('--json', action='store_true', help='print the results as JSON')
    grade.add_argument(
        '--allow-weak',
        choices=WEAK,
        default='',
        metavar='MODE',
        help='accept isolation down to this where none of the better works: '
        f'{", ".join(WEAK)} (see docs/threat-model.md)',
    )
    grade.set_defaults(run=_grade)


def _positive(text: str) -> int:
    """Read a whole number of at least one."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'expected a whole number of at least 1, got {text!r}')
    return int(text)


def _grade(chosen: argparse.Namespace) -> int:
    """Grade a class."""
    from rich.console import Console

    # What ends a job of a cluster or a service is as good as Ctrl-C: nothing is left behind.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    _fit_together(chosen)
    layout = Layout.here()
    told = Console(stderr=chosen.json, width=None if sys.stdout.isatty() else 120)
    with alone(layout, 'a grading'):
        submitted = submitted_folder(layout, chosen.submitted, told)
        assignments = _assignments(layout, chosen.assignment)
        with grading_folder(), _engine(layout, chosen, told) as (engine, jobs):
            results, trouble = _grade_all(layout, assignments, submitted, engine, jobs, told)
    if not results:
        raise UsageError(
            f'{submitted}: expected STUDENT/ASSIGNMENT folders with one of '
            f'{", ".join(assignments)}, got none of them.'
        )
    if chosen.json:
        print(json.dumps([result.to_json() for result in results]))
    if trouble:
        raise GraderError(trouble)
    return FOR_REVIEW if any(result.fault for result in results) else OK


def _fit_together(chosen: argparse.Namespace) -> None:
    """Refuse options of which one would be ignored."""
    if chosen.cluster and chosen.allow_weak:
        raise UsageError(
            f'--allow-weak {chosen.allow_weak}: expected none with --cluster, whose workers '
            'isolate fully or refuse. Try: leave it out'
        )
    if chosen.cluster and chosen.jobs:
        raise UsageError(
            f'--jobs {chosen.jobs}: expected none with --cluster, whose workers say how many runs '
            'they take. Try: leave it out'
        )


def _grade_all(
    layout: Layout,
    assignments: Sequence[str],
    submitted: Path,
    engine: Engine,
    jobs: int,
    told: Console,
) -> tuple[list[SubmissionResult], str]:
    """Grade each assignment; return all results, and what the gradebook refused."""
    results: list[SubmissionResult] = []
    trouble: list[str] = []
    for assignment in assignments:
        try:
            results += _grade_assignment(layout, assignment, submitted, engine, jobs, told)
        except NotEnteredError as error:
            results += error.results
            trouble.append(str(error))
    return results, ' '.join(dict.fromkeys(trouble))


@contextmanager
def _engine(
    layout: Layout, chosen: argparse.Namespace, told: Console
) -> Iterator[tuple[Engine, int]]:
    """Yield what runs exams, in a pool or on a cluster, and how many at a time."""
    if chosen.cluster:
        from autograder.runs.cluster import cluster_engine

        with cluster_engine(chosen.cluster, layout, chosen.fresh) as engine:
            assert engine.place is not None
            told.print(
                f'{engine.place.width} runs at a time on {chosen.cluster}.', highlight=False
            )
            yield engine, max(engine.place.width, AHEAD)
        return
    from autograder.whole_class.pipeline import grading_engine

    engine = grading_engine(layout, chosen.fresh, chosen.allow_weak)
    jobs = warn_if_weak(engine, chosen.jobs or processors(), told)
    with in_a_pool(engine, jobs) as pooled:
        # One thread more than processes: while one judges, all of them have something to run.
        yield pooled, jobs + 1


@contextmanager
def in_a_pool(engine: SandboxEngine, jobs: int) -> Iterator[SandboxEngine]:
    """
    Yield an engine that runs in processes of its own.

    :param jobs: how many processes
    """
    with Pool(jobs) as place:
        yield replace(engine, place=place)


def warn_if_weak(engine: Engine, jobs: int, told: Console) -> int:
    """Print the banner of a weak mode; return how many runs at a time may be."""
    mode = getattr(getattr(engine, 'sandbox', None), 'mode', '')
    if not not_protected(mode):
        return jobs
    told.print(banner(mode), style='bold red', highlight=False, markup=False)
    return 1


def submitted_folder(layout: Layout, chosen: Path | None, told: Console) -> Path:
    """Return the folder to grade; the default one is filled with the sample class if empty."""
    if chosen is not None:
        if not chosen.is_dir():
            raise UsageError(f'--submitted {chosen}: expected a folder, got none.')
        return chosen.resolve()
    if not layout.submitted.is_dir() or not any(layout.submitted.iterdir()):
        if layout.reports.is_dir():  # a class was here: its page is no place for sample students
            raise UsageError(
                f'{layout.submitted}: expected submissions, got an empty folder. Try: python -m '
                'autograder collect SOURCE, or sample-class for the example submissions'
            )
        from autograder.sample_class import write_sample_class

        count = write_sample_class(layout, layout.submitted)
        told.print(
            f'autograder/_work/submitted is empty, so the {count} example submissions of '
            'tests/submissions were put there.',
            highlight=False,
        )
    return layout.submitted


def _assignments(layout: Layout, chosen: str | None) -> tuple[str, ...]:
    """Return which assignments to grade."""
    known = layout.assignments()
    if not known:
        raise UsageError('notebooks/ holds no assignment. Generate it with: make release')
    return known if chosen is None else (layout.assignment_named(chosen),)


def _grade_assignment(
    layout: Layout, assignment: str, submitted: Path, engine: Engine, jobs: int, told: Console
) -> list[SubmissionResult]:
    """Grade one assignment of a class, record it, write the reports, print the table."""
    from autograder.whole_class.class_results import lowered
    from autograder.whole_class.entering import Entering
    from autograder.whole_class.pipeline import grade_class, load_lesson

    lesson = load_lesson(layout, assignment, engine)
    submissions = _submissions(layout, lesson, submitted)
    if not submissions:
        return []
    others = _others(layout, assignment, submitted, {one.student for one in submissions})
    graded_in_full = getattr(engine, 'hidden', True)  # visible checks alone make no grade
    entering = Entering(layout, lesson)
    began = time.monotonic()
    totals = Totals()
    with progress(len(submissions) * len(lesson.exams), assignment) as show:
        graded = grade_class(
            submissions,
            lesson,
            engine,
            jobs,
            _both(totals.add, show),
            meanwhile=entering.meanwhile if graded_in_full else lambda ready: None,
        )
    graded_s = time.monotonic() - began
    new, refused = entering.finish(graded) if graded_in_full else (0, '')
    results = [one.result for one in graded]
    summary = _summary(graded, graded_s, time.monotonic() - began, totals)
    if graded_in_full and new < len(graded):
        summary += f' {len(graded) - new} were in the gradebook as they are.'
    if fewer := lowered(layout, assignment, results):
        summary += f' Fewer points than before: {", ".join(fewer[:MOST_NAMED])}'
        summary += f' and {len(fewer) - MOST_NAMED} others.' if fewer[MOST_NAMED:] else '.'
    if others:
        summary += f' Not in this folder, kept as they were: {len(others)} others.'
    _report(layout, assignment, results, others, summary, told)
    if refused:
        raise NotEnteredError(refused, results)
    return results


def _submissions(layout: Layout, lesson: Lesson, submitted: Path) -> tuple[Submission, ...]:
    """Return what was handed in for an assignment."""
    from autograder.whole_class.inbox import discover

    try:
        return discover(submitted, lesson.assignment, lesson.notebook, layout.assignments())
    except OSError as error:
        raise UsageError(f'{submitted}: cannot be read: {error.strerror}.') from error


def _others(
    layout: Layout, assignment: str, submitted: Path, students: Collection[str]
) -> tuple[SubmissionResult, ...]:
    """
    Return the results that stay: of those who are not in a folder that is not the course's own.

    It is read before anything is run, so that results that cannot be read cost no grading.
    """
    from autograder.whole_class.class_results import results_of_others

    if submitted.resolve() == layout.submitted.resolve():
        return ()
    return results_of_others(layout, assignment, students)


def _report(
    layout: Layout,
    assignment: str,
    results: Sequence[SubmissionResult],
    others: Sequence[SubmissionResult],
    summary: str,
    told: Console,
) -> None:
    """Write the reports of everybody, and print the table of those who were graded now."""
    from autograder.whole_class.class_report import write_class_report
    from autograder.whole_class.people import read_people
    from autograder.whole_class.report import print_table, write_reports

    people = read_people(layout)
    everybody = sorted((*results, *others), key=lambda one: one.student)
    index = write_reports(layout.reports, assignment, everybody, summary, people)
    write_class_report(layout, assignment, summary)
    print_table(told, assignment, results, people)
    told.print(summary, highlight=False, markup=False)
    told.print(f'Reports: {short(index, layout)}', highlight=False, soft_wrap=True)


def _both(one: Callable[[Done], None], two: Callable[[Done], None]) -> Callable[[Done], None]:
    def tell(done: Done) -> None:
        one(done)
        two(done)

    return tell


def _summary(graded: Sequence[Graded], graded_s: float, total_s: float, totals: Totals) -> str:
    """Say how many, how long and how isolated."""
    reviews = sum(bool(one.result.fault) for one in graded)
    exams = [exam for one in graded for exam in one.result.exams]
    modes = sorted({exam.mode for exam in exams if exam.mode})
    some = f'{len(graded)} submission{"s" * (len(graded) != 1)}'
    parts = [f'{some} in {total_s:.1f} s ({graded_s:.1f} s of it running)']
    slowest = totals.slowest_text()
    if slowest and len(graded) > 1:
        parts.append(printable(slowest))
    if modes:
        parts.append(f'isolation {", ".join(modes)}')
    if reviews:
        parts.append(f'{reviews} for review')
    return f'{"; ".join(parts)}.'


def short(path: Path, layout: Layout) -> str:
    """Return a path as seen from the course."""
    return str(path.relative_to(layout.root)) if path.is_relative_to(layout.root) else str(path)
