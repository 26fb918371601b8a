"""
Run one exam on the files of a package; ``check(...)`` in a notebook starts this program.

    python -m autograder.commands.check EXAM --files DIR --visible [--json]

``python -m autograder check`` does the same.  This module can run on its own because the
students' copy of the course contains no other command.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import asdict
import json
import os
from pathlib import Path
import sys
from typing import Any, TYPE_CHECKING

from autograder.commands import describe, JSON, OK, option, show, takes, USAGE, VISIBLE
from autograder.errors import from_os_error, GraderError, SandboxUnavailable, UsageError
from autograder.layout import Layout
from autograder.results import Problem
from environment.ros import RosEnvironmentError

if TYPE_CHECKING:
    from autograder.exam.exam import Exam

REFUSALS = (GraderError, RosEnvironmentError, OSError, ModuleNotFoundError)
"""Errors that the command reports in one line."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit code."""
    parser = argparse.ArgumentParser(prog='python -m autograder.commands.check')
    describe(parser, run)
    chosen = parser.parse_args(arguments)
    try:
        return run(chosen)
    except REFUSALS as error:
        refuse(error, chosen.json)
        return USAGE


@takes(
    option('exam', 'name of the exam, such as talker', metavar='EXAM'),
    option('--files', 'folder of the package', type=Path, required=True, metavar='DIR'),
    VISIBLE,
    JSON,
)
def run(chosen: argparse.Namespace) -> int:
    """Run one exam on a package; a visible exam runs even without isolation."""
    from autograder.exam import catalog
    from autograder.explaining.feedback import exam_text
    from autograder.grading.examine import Engine
    from autograder.submission.package import (
        describe_files,
        name_missing,
        own_files,
        read_package,
        read_upload,
        with_node_files,
    )

    if not chosen.files.is_dir():
        raise UsageError(f'--files {chosen.files}: there is no such folder.')
    exam = catalog.load(chosen.exam, hidden=not chosen.visible)
    if chosen.visible and exam.scenario.program != 'package':
        found = read_package(chosen.files)
        files = own_files(exam, found)
    else:
        found = files = with_node_files(read_upload(chosen.files), exam.requires)
    missing = [name for name in exam.requires if name not in files]
    if missing and not chosen.json:
        there = describe_files(found)
        raise UsageError(f'{chosen.files}: expected {", ".join(missing)}, got {there}.')
    engine = Engine(sandbox_for(chosen.visible), _kept_builds(exam) if chosen.visible else None)
    result = name_missing(engine.run(exam, files), found)
    show(chosen.json, result.to_json(), exam_text(result).rstrip('\n'))
    return OK


def _kept_builds(exam: Exam) -> Path | None:
    """Return the folder of recordings if it can save the next check a build, else None."""
    folder = Layout.here().recordings
    if exam.scenario.program not in ('build', 'package'):
        return None
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None  # The course is read-only, so every check builds the package.
    return folder if os.access(folder, os.W_OK) else None


def sandbox_for(visible: bool) -> Any:
    """Return the strongest sandbox that works here; visible checks may run without isolation."""
    from autograder.sandboxes import choose

    try:
        return choose.strongest()
    except SandboxUnavailable as error:
        if not visible:
            raise
        print(
            f'The program runs as a plain process, because no sandbox works here: {error.what}',
            file=sys.stderr,
        )
        return choose.usable('none')


# -- reporting errors -----------------------------------------------------------------------


def refuse(error: Exception, as_json: bool) -> None:
    """Print why the command failed: one line on stderr, and JSON on stdout if requested."""
    what, fix = _what_and_fix(error)
    print(f'autograder: {" ".join(f"{what} {fix}".split())}', file=sys.stderr)
    if as_json:
        fix = (
            fix.removeprefix('Try: ').rstrip('.')
            or 'run the cell again; if the error persists, type make doctor in a terminal'
        )
        where = 'the checker itself, not your code'
        problem = Problem(where, 'a verdict', what.rstrip(' .'), fix)
        print(json.dumps({'error': asdict(problem)}))


def _what_and_fix(error: Exception) -> tuple[str, str]:
    if isinstance(error, GraderError):
        return error.what, error.fix
    if isinstance(error, ModuleNotFoundError):
        what = f'{sys.executable}: this Python has no module {error.name}.'
        return what, 'Try: make grade, or .venv/bin/autograder'
    if isinstance(error, OSError) and error.strerror:
        said = from_os_error(error)
        return said.what, said.fix
    what, found, fix = str(error).partition('Try: ')
    return what, found + fix


if __name__ == '__main__':
    sys.exit(main())
