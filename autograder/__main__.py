"""
The grader on the command line: ``python -m autograder grade | check | sample-class``.

Exit codes: 0 everything has a verdict, 1 some submissions are for review, 2 the command cannot
be done (its arguments, or our own fault), 130 stopped by Ctrl-C.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from contextlib import contextmanager
import json
import os
from pathlib import Path
import sys
import time
from typing import Any, TYPE_CHECKING

from autograder.commands import add_commands
from autograder.errors import GraderError, SandboxUnavailable
from autograder.isolation import banner, not_protected, WEAK
from autograder.layout import Layout
from autograder.pipeline import end_runs
from environment.ros import EnvironmentError_

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import Console

    from autograder.pipeline import Engine, Graded
    from autograder.results import SubmissionResult

OK, FOR_REVIEW, USAGE, STOPPED = 0, 1, 2, 130
OURS = ('autograder', 'environment', 'roslab')


class UsageError(Exception):
    """The command line asks for something that is not there."""


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run one command.

    :param arguments: the command line without the program
    :returns: the exit code
    """
    chosen = _parser().parse_args(arguments)
    try:
        code: int = chosen.run(chosen)
    except (UsageError, GraderError, EnvironmentError_, OSError, ModuleNotFoundError) as error:
        if isinstance(error, ModuleNotFoundError) and str(error.name).partition('.')[0] in OURS:
            if (Path(__file__).parent / 'exams' / 'hidden').is_dir():
                raise  # a defect of ours, not of the Python in use
            error = UsageError(
                f'This is the copy of the course that students have, and {chosen.command} needs '
                'the full project. Visible checks work here: python -m autograder check EXAM '
                '--files FOLDER --visible'
            )
        return _refuse(error, chosen.run is _check and chosen.json)
    except KeyboardInterrupt:
        print('\nStopped. Finished runs are kept; the same command goes on.', file=sys.stderr)
        if not end_runs():
            os._exit(STOPPED)
        return STOPPED
    return code


def _refuse(error: Exception, as_json: bool) -> int:
    """Say in one line why the command cannot be done."""
    what, fix = _what_and_fix(error)
    print(f'autograder: {" ".join(f"{what} {fix}".split())}', file=sys.stderr)
    if as_json:
        print(json.dumps({'error': _as_problem(what, fix)}))
    return USAGE


def _what_and_fix(error: Exception) -> tuple[str, str]:
    """Return what went wrong and what to do about it."""
    if isinstance(error, GraderError):
        return error.what, error.fix
    if isinstance(error, ModuleNotFoundError):
        what = f'{sys.executable}: expected a Python that has {error.name}, got one without it.'
        return what, 'Try: run it with make grade or .venv/bin/python -m autograder'
    if isinstance(error, OSError) and error.strerror:
        where = 'the system' if error.filename is None else error.filename
        what = f'{where}: expected a file or folder to work with, got: {error.strerror.lower()}.'
        return what, 'Try: check its permissions and the free space on the disk'
    what, found, fix = str(error).partition('Try: ')
    return what, found + fix


def _parser() -> argparse.ArgumentParser:
    """Describe the command line."""
    parser = argparse.ArgumentParser(prog='python -m autograder', description=__doc__)
    commands = parser.add_subparsers(required=True, metavar='COMMAND', dest='command')

    grade = commands.add_parser('grade', help='grade a class and write reports')
    grade.add_argument(
        '--submitted',
        type=Path,
        metavar='DIR',
        help='folder of STUDENT/ASSIGNMENT/NOTEBOOK.ipynb (default: autograder/_work/submitted)',
    )
    grade.add_argument('--assignment', metavar='NAME', help='only this one (default: all)')
    grade.add_argument(
        '--jobs',
        type=_positive,
        default=(os.cpu_count() or 1) + 1,
        metavar='N',
        help='runs at a time (default: one more than processors, as runs wait; here %(default)s)',
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

    check = commands.add_parser('check', help='run one exam on the files of a package')
    check.add_argument('exam', metavar='EXAM')
    check.add_argument('--files', type=Path, required=True, metavar='DIR', help='the package')
    check.add_argument('--visible', action='store_true', help='only the visible checks')
    check.add_argument('--json', action='store_true', help='print the result as JSON')
    check.set_defaults(run=_check)

    sample = commands.add_parser('sample-class', help='write the bundled example submissions')
    sample.add_argument('--to', type=Path, metavar='DIR', help='default: the submitted folder')
    sample.set_defaults(run=_sample_class)

    proof = commands.add_parser(
        'self-check', help='grade the reference solution and the bare release of every lesson'
    )
    proof.set_defaults(run=_self_check)
    add_commands(commands)
    return parser


def _positive(text: str) -> int:
    """Read a whole number of at least one."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f'expected a whole number of at least 1, got {text!r}')
    return int(text)


def _self_check(chosen: argparse.Namespace) -> int:
    """Show that the reference passes every exam here and that the bare release does not."""
    from autograder.pipeline import grading_engine
    from autograder.self_check import self_check

    layout = Layout.here()
    code = 0
    for right, line in self_check(layout, grading_engine(layout)):
        print(line, flush=True)
        code = code if right else FOR_REVIEW
    return code


# -- grade ----------------------------------------------------------------------------------


def _grade(chosen: argparse.Namespace) -> int:
    """Grade a class."""
    from rich.console import Console

    from autograder.pipeline import grading_engine

    layout = Layout.here()
    told = Console(stderr=chosen.json, width=None if sys.stdout.isatty() else 120)
    submitted = _submitted_folder(layout, chosen.submitted, told)
    assignments = _assignments(layout, chosen.assignment)
    engine = grading_engine(layout, chosen.fresh, chosen.allow_weak)
    jobs = _warn_if_weak(engine, chosen.jobs, told)
    results: list[SubmissionResult] = []
    trouble = ''
    for assignment in assignments:
        try:
            results += _grade_assignment(layout, assignment, submitted, engine, jobs, told)
        except NotEnteredError as error:
            results += error.results
            trouble = str(error)
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


def _warn_if_weak(engine: Engine, jobs: int, told: Console) -> int:
    """Print the banner of a weak mode; return how many runs at a time may be."""
    mode = getattr(getattr(engine, 'sandbox', None), 'mode', '')
    if not not_protected(mode):
        return jobs
    told.print(banner(mode), style='bold red', highlight=False, markup=False)
    return 1


class NotEnteredError(GraderError):
    """The results are there, but nbgrader's gradebook refused some of them."""

    def __init__(self, what: str, results: Sequence[SubmissionResult]) -> None:
        """Keep the results, which are reported all the same."""
        super().__init__(what)
        self.results = tuple(results)


def _submitted_folder(layout: Layout, chosen: Path | None, told: Console) -> Path:
    """Return the folder to grade; the default one is filled with the sample class if empty."""
    if chosen is not None:
        if not chosen.is_dir():
            raise UsageError(f'--submitted {chosen}: expected a folder, got none.')
        return chosen.resolve()
    if not layout.submitted.is_dir() or not any(layout.submitted.iterdir()):
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
    if chosen is None:
        return known
    if chosen not in known:
        from difflib import get_close_matches

        close = get_close_matches(chosen, known, n=1, cutoff=0.3)
        hint = f'Did you mean {close[0]}?' if close else f'Known: {", ".join(known)}.'
        raise UsageError(f'--assignment {chosen}: there is no such assignment. {hint}')
    return (chosen,)


def _grade_assignment(
    layout: Layout, assignment: str, submitted: Path, engine: Engine, jobs: int, told: Console
) -> list[SubmissionResult]:
    """Grade one assignment of a class, record it, write the reports, print the table."""
    from autograder.inbox import discover
    from autograder.pipeline import grade_class, load_lesson
    from autograder.record import enter_assignment, record
    from autograder.report import print_table, write_reports

    lesson = load_lesson(layout, assignment, engine)
    try:
        submissions = discover(submitted, assignment, lesson.notebook, layout.assignments())
    except OSError as error:
        raise UsageError(f'{submitted}: cannot be read: {error.strerror}.') from error
    if not submissions:
        return []
    graded_in_full = getattr(engine, 'hidden', True)  # visible checks alone make no grade
    began = time.monotonic()
    with _progress(len(submissions) * len(lesson.exams)) as done:
        graded = grade_class(
            submissions,
            lesson,
            engine,
            jobs,
            done,
            meanwhile=lambda: enter_assignment(layout, assignment) if graded_in_full else None,
        )
    graded_s = time.monotonic() - began
    refused = ''
    try:
        if graded_in_full:
            record(layout, lesson, graded)
    except GraderError as error:
        refused = str(error)
    total_s = time.monotonic() - began
    results = [one.result for one in graded]
    summary = _summary(graded, graded_s, total_s)
    index = write_reports(layout.reports, assignment, results, summary)
    print_table(told, assignment, results)
    told.print(summary, highlight=False)
    told.print(f'Reports: {_short(index, layout)}', highlight=False, soft_wrap=True)
    if refused:
        raise NotEnteredError(refused, results)
    return results


def _summary(graded: Sequence[Graded], graded_s: float, total_s: float) -> str:
    """Say how many, how long and how isolated."""
    reviews = sum(bool(one.result.fault) for one in graded)
    exams = [exam for one in graded for exam in one.result.exams]
    modes = sorted({exam.mode for exam in exams if exam.mode})
    parts = [f'{len(graded)} submissions in {total_s:.1f} s ({graded_s:.1f} s of it running)']
    if modes:
        parts.append(f'isolation {", ".join(modes)}')
    if reviews:
        parts.append(f'{reviews} for review')
    return f'{"; ".join(parts)}.'


def _short(path: Path, layout: Layout) -> str:
    """Return a path as seen from the course."""
    return str(path.relative_to(layout.root)) if path.is_relative_to(layout.root) else str(path)


@contextmanager
def _progress(total: int) -> Iterator[Callable[[], None]]:
    """Show a progress bar on a terminal; be quiet in a log."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    console = Console(stderr=True)
    quiet = not console.is_terminal or bool(os.environ.get('CI'))
    columns: tuple[Any, ...] = (
        'Grading',
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, disable=quiet, transient=True) as progress:
        task = progress.add_task('grade', total=total)
        yield lambda: progress.advance(task)


# -- check ----------------------------------------------------------------------------------


def _check(chosen: argparse.Namespace) -> int:
    """Run one exam on a package; the visible one also runs where nothing isolates."""
    from autograder import exams
    from autograder.examine import examine
    from autograder.intake import read_handed_in, with_node_files
    from autograder.package import name_missing, read_package, what_is_there

    if not chosen.files.is_dir():
        raise UsageError(f'--files {chosen.files}: expected a package folder, got none.')
    exam = exams.load(chosen.exam, hidden=not chosen.visible)
    if chosen.visible:
        files = read_package(chosen.files)  # the files a notebook made, as grading sees them
    else:
        files = with_node_files(read_handed_in(chosen.files), exam.requires)
    missing = [name for name in exam.requires if name not in files]
    if missing and not chosen.json:
        there = what_is_there(files)
        raise UsageError(f'{chosen.files}: expected {", ".join(missing)}, got {there}.')
    sandbox, said = _sandbox(allow_plain=chosen.visible)
    result = name_missing(examine(exam, files, sandbox=sandbox), files)
    if said:
        print(said, file=sys.stderr)
    if chosen.json:
        print(json.dumps(result.to_json()))
    else:
        from autograder.feedback import exam_text

        print(exam_text(result), end='')
    return OK


def _as_problem(what: str, fix: str) -> dict[str, Any]:
    """Return why there is no verdict, for a program that shows it."""
    from dataclasses import asdict

    from autograder.results import Problem

    fix = (
        fix.removeprefix('Try: ').rstrip('.')
        or 'run it again; if it stays, type make doctor in a terminal'
    )
    where = 'the checker itself, not your code'
    return asdict(Problem(where, 'a verdict', what.rstrip(' .'), fix))


def _sandbox(allow_plain: bool) -> tuple[Any, str]:
    """Return the sandbox to use and what is to be said about it."""
    from autograder import sandbox

    try:
        return sandbox.strongest(), ''
    except SandboxUnavailable as error:
        if not allow_plain:
            raise
        return sandbox.plain(), f'No sandbox here, so this ran as a plain process: {error.what}'


# -- sample-class ---------------------------------------------------------------------------


def _sample_class(chosen: argparse.Namespace) -> int:
    """Write the bundled class."""
    from autograder.sample_class import write_sample_class

    layout = Layout.here()
    folder = (chosen.to or layout.submitted).resolve()
    count = write_sample_class(layout, folder)
    print(f'{count} submissions are in {_short(folder, layout)}.')
    return OK


if __name__ == '__main__':
    sys.exit(main())
