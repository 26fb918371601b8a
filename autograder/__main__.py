"""
The grader on the command line; COMMAND --help says more about each.

Exit codes: 0 everything has a verdict, 1 some submissions are for review, 2 the command cannot
be done (its arguments, or our own fault), 130 stopped by Ctrl-C, 141 its output is not read to
the end, as in '... | head'.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
import json
import os
from pathlib import Path
import select
import sys
from typing import Any, TYPE_CHECKING

from autograder.commands import add_commands
from autograder.commands_class import add_class_commands
from autograder.errors import GraderError, SandboxUnavailable
from autograder.layout import Layout
from autograder.whole_class.grading import add_grade, FOR_REVIEW, OK, short, UsageError
from autograder.whole_class.pipeline import end_runs
from environment.ros import EnvironmentError_

if TYPE_CHECKING:
    from autograder.judging.exam import Exam

USAGE, STOPPED, UNREAD = 2, 130, 141
GOES_ON = {
    'grade': 'Finished runs are kept; the same command goes on.',
    'collect': 'What was taken stays; the same command goes on.',
}
"""Commands of which something is kept if they are stopped."""
OURS = ('autograder', 'drawing', 'environment', 'roslab')


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run one command.

    :param arguments: the command line without the program
    :returns: the exit code
    """
    chosen = _parser().parse_args(arguments)
    try:
        code: int = chosen.run(chosen)
        sys.stdout.flush()
    except (UsageError, GraderError, EnvironmentError_, OSError, ModuleNotFoundError) as error:
        if isinstance(error, BrokenPipeError) and _nobody_reads():
            end_runs()
            return UNREAD
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
        print(f'\nStopped. {_how_to_go_on(chosen)}', file=sys.stderr)
        if not end_runs():
            os._exit(STOPPED)
        return STOPPED
    return code


def _nobody_reads() -> bool:
    """
    Tell whether standard output is a pipe that its reader has closed.

    If so it is led away, or Python itself would complain at its end.
    """
    try:
        output = sys.stdout.fileno()
    except (OSError, ValueError):  # no file of the system's
        return False
    looked_at = select.poll()
    looked_at.register(output, 0)  # errors are always reported
    if not any(what & select.POLLERR for _, what in looked_at.poll(0)):
        return False
    os.dup2(os.open(os.devnull, os.O_WRONLY), output)
    return True


def _how_to_go_on(chosen: argparse.Namespace) -> str:
    """Say what is kept of a command that was stopped."""
    if chosen.command not in GOES_ON:
        return 'The same command begins again.'
    if getattr(chosen, 'fresh', False):
        return (
            'What was reported is done. The same command begins again, as --fresh repeats every '
            'run; --assignment NAME limits it to what is missing.'
        )
    return GOES_ON[chosen.command]


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

    add_grade(commands)
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
    add_class_commands(commands)
    return parser


def _self_check(chosen: argparse.Namespace) -> int:
    """Show that the reference passes every exam here and that the bare release does not."""
    from autograder.self_check import self_check
    from autograder.whole_class.pipeline import grading_engine

    layout = Layout.here()
    code = 0
    for right, line in self_check(layout, grading_engine(layout)):
        print(line, flush=True)
        code = code if right else FOR_REVIEW
    return code


# -- check ----------------------------------------------------------------------------------


def _check(chosen: argparse.Namespace) -> int:
    """Run one exam on a package; the visible one also runs where nothing isolates."""
    from autograder import exams
    from autograder.handed_in.intake import read_handed_in, with_node_files
    from autograder.handed_in.package import name_missing, own_files, read_package, what_is_there
    from autograder.runs.examine import examine

    if not chosen.files.is_dir():
        raise UsageError(f'--files {chosen.files}: expected a package folder, got none.')
    exam = exams.load(chosen.exam, hidden=not chosen.visible)
    if chosen.visible:
        files = own_files(exam, read_package(chosen.files))
    else:
        files = with_node_files(read_handed_in(chosen.files), exam.requires)
    missing = [name for name in exam.requires if name not in files]
    if missing and not chosen.json:
        there = what_is_there(files)
        raise UsageError(f'{chosen.files}: expected {", ".join(missing)}, got {there}.')
    sandbox, said = _sandbox(allow_plain=chosen.visible)
    kept = _kept_builds(exam) if chosen.visible else None
    result = name_missing(examine(exam, files, sandbox=sandbox, recordings=kept), files)
    if said:
        print(said, file=sys.stderr)
    if chosen.json:
        print(json.dumps(result.to_json()))
    else:
        from autograder.explaining.feedback import exam_text

        print(exam_text(result), end='')
    return OK


def _kept_builds(exam: Exam) -> Path | None:
    """Return where the runs of visible checks that build are kept: unchanged files build once."""
    folder = Layout.here().recordings
    if exam.scenario.program != 'build':
        return None
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None  # a course that may only be read: every check builds
    return folder if os.access(folder, os.W_OK) else None


def _as_problem(what: str, fix: str) -> dict[str, Any]:
    """Return why there is no verdict, for a program that shows it."""
    from dataclasses import asdict

    from autograder.judging.results import Problem

    fix = (
        fix.removeprefix('Try: ').rstrip('.')
        or 'run it again; if it stays, type make doctor in a terminal'
    )
    where = 'the checker itself, not your code'
    return asdict(Problem(where, 'a verdict', what.rstrip(' .'), fix))


def _sandbox(allow_plain: bool) -> tuple[Any, str]:
    """Return the sandbox to use and what is to be said about it."""
    from autograder.sandboxes import sandbox

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
    print(f'{count} submissions are in {short(folder, layout)}.')
    return OK


if __name__ == '__main__':
    sys.exit(main())
