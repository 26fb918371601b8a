"""
Visible checks: the grader's own engine, run on the learner's saved files.

The learner's code never runs in the kernel for this.  A child process runs it, in a sandbox where
there is one, and prints its verdicts as one line of JSON.
"""

from __future__ import annotations

from collections.abc import Mapping
import json
import os
from pathlib import Path
import sys
import tempfile
from typing import Any

from autograder import exams
from autograder.errors import ExamInvalid
from autograder.handed_in.cells import UNSOLVED
from autograder.judging.results import ExamResult, Problem
from autograder.layout import Layout
from roslab import child
from roslab.output import ElapsedTime
from roslab.package_files import learner_package, LearnerPackage
from roslab.report import CheckReport

_DEADLINE_S = 180.0


def check(exam: str) -> CheckReport:
    """
    Run the visible checks of an exercise and show the result.

    :param exam: name of the exercise, such as 'temperature_publisher'
    :returns: the report, true if every check passed
    :raises AssertionError: only under nbgrader's Validate, if a check failed
    """
    report = _run(exam, learner_package())
    report.show()
    if os.environ.get('NBGRADER_EXECUTION') == 'validate' and not report:
        raise AssertionError(str(report))
    return report


def _run(exam: str, package: LearnerPackage) -> CheckReport:
    files = package.files() if package.folder.is_dir() else {}
    if not files:
        return CheckReport(
            exam,
            problem=Problem(
                where=f'check({exam!r})',
                expected='saved files of the exercise',
                got='none',
                try_this='run the cells of the exercise first, those that begin with %%',
            ),
        )
    command = [sys.executable, '-m', 'autograder', 'check', exam]
    # In an empty folder: a file of the learner's beside the notebook must not replace a module.
    with (
        tempfile.TemporaryDirectory(prefix='check-') as empty,
        ElapsedTime(f'Checking {exam}') as elapsed,
    ):
        outcome = child.run(
            [*command, '--files', str(package.folder), '--visible', '--json'],
            cwd=Path(empty),
            env=os.environ,
            deadline_s=_DEADLINE_S,
            on_tick=elapsed.tick,
        )
    report = _read(exam, outcome, tuple(_unfinished(exam, files)))
    report.lesson = _lesson_of(exam)
    return report


def _lesson_of(exam: str) -> str | None:
    """Return the file name of the lesson that an exercise belongs to, None if there is none."""
    try:
        return Layout.here().release(exams.load(exam, hidden=False).assignment).name
    except (ExamInvalid, FileNotFoundError):
        return None


def _unfinished(exam: str, files: Mapping[str, str]) -> list[str]:
    """Return the files that still are stubs, of those that the exercise is about."""
    try:
        about = {Path(name).name for name in exams.load(exam, hidden=False).requires}
    except ExamInvalid:
        return []  # no such exercise: the checker says so, with the names that exist
    return [
        name
        for name, text in files.items()
        if Path(name).name in about
        and UNSOLVED in text
        and (not name.endswith('.py') or 'NotImplementedError' in text)
    ]


def _read(exam: str, outcome: child.Outcome, unfinished: tuple[str, ...]) -> CheckReport:
    """Read what the child printed last; anything else is the checker's fault and says so."""
    answer = _last_json(outcome.output)
    try:
        if 'error' in answer:
            return CheckReport(
                exam, problem=Problem.from_json(answer['error']), unfinished=unfinished
            )
        return CheckReport(exam, ExamResult.from_json(answer), unfinished=unfinished)
    except (KeyError, TypeError, ValueError):
        pass
    if outcome.returncode is None:
        got = f'no answer within {_DEADLINE_S:.0f} s'
    else:
        got = f'exit code {outcome.returncode} and no verdict: {_tail(outcome.output)}'
    problem = Problem(
        where='the checker itself, not your code',
        expected='a verdict',
        got=got,
        try_this='run the cell again; if it stays, type make doctor in a terminal',
    )
    return CheckReport(exam, problem=problem, unfinished=unfinished)


def _last_json(output: str) -> dict[str, Any]:
    lines = [line for line in output.splitlines() if line.startswith('{')]
    try:
        answer = json.loads(lines[-1]) if lines else {}
    except ValueError:
        return {}
    return answer if isinstance(answer, dict) else {}


def _tail(output: str) -> str:
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return lines[-1][:300] if lines else 'it printed nothing'
