"""
Copy this course with a single part of a lesson, to measure one exam alone.

The copy contains an unchanged copy of the grader; only the other exams are missing, and the
notebook contains only the publisher.  The copy has a separate gradebook and separate recordings,
so a measurement neither reads nor changes those of the course.
"""

from collections.abc import Mapping, Sequence
import copy
from dataclasses import dataclass
import json
import os
from pathlib import Path
import re
import shutil
import subprocess
import sys
import time
from typing import Any

from autograder.authoring.sample_class import compose
from autograder.gradebook import converters
from autograder.layout import Layout
from autograder.submission.notebook import marks_of, read_release
from autograder.submission.submission import answer_files

ASSIGNMENT = '07_temperature_monitor'
EXAM = 'temperature_publisher'
KEPT_CELLS = ('spec_publisher', EXAM, f'check_{EXAM}')
REFERENCE = 'pass__reference'
SIX = (
    REFERENCE,
    'pass__lambda_and_subclass',
    'fail__two_hertz',
    'fail__topic_typo',
    'fail__best_effort',
    'error__exception_in_callback',
)
"""Two correct and four wrong submissions; a test in the kernel can detect all four mistakes."""


def publishers(names: Sequence[str]) -> dict[str, str]:
    """
    Return the publisher file of each named sample submission.

    :param names: folders of ``tests/submissions/07_temperature_monitor``
    :raises SystemExit: if a sample does not exist
    """
    layout = Layout.here()
    folder = layout.sample_class / ASSIGNMENT
    unknown = [name for name in names if not (folder / name / 'expected.json').is_file()]
    if unknown:
        known = ', '.join(sorted(path.name for path in folder.iterdir()))
        raise SystemExit(f'{", ".join(unknown)}: no such sample submission. Known: {known}.')
    notebooks = {name: json.loads(compose(layout, ASSIGNMENT, folder / name)) for name in names}
    return {name: answer_files(notebook)[EXAM].body for name, notebook in notebooks.items()}


def build(
    root: Path, answers: Mapping[str, str], seconds: int, more: str = '', more_points: float = 0
) -> Layout:
    """
    Make the copy and submit the answers.

    :param root: an empty folder
    :param answers: text of ``temp_publisher.py``, by student
    :param seconds: duration of the exam, and of its second start [virtual s]
    :param more: code of additional checks, appended to the exam's module
    :param more_points: points of the additional checks
    """
    course, layout = Layout.here(), Layout(root)
    for name in ('autograder', 'exams'):
        shutil.copytree(course.root / name, root / name, ignore=_left_out)
    for name in ('course.toml', 'nbgrader_config.py'):
        shutil.copy2(course.root / name, root)
    exam = root / 'exams' / 'hidden' / f'{EXAM}.py'
    replace_once(exam, 'seconds=WATCH_S', f'seconds={seconds}')
    replace_once(exam, 'warming_s=300.0', f'warming_s={seconds}')
    exam.write_text(exam.read_text(encoding='utf-8') + more, encoding='utf-8')
    name = course.release(ASSIGNMENT).name
    notebook = read_release(course.solutions / ASSIGNMENT / name)
    cells = {marks_of(cell).get('grade_id'): cell for cell in notebook['cells']}
    notebook['cells'] = [cells[kept] for kept in KEPT_CELLS]
    marks_of(cells[f'check_{EXAM}'])['points'] += more_points
    solution = layout.solutions / ASSIGNMENT / name
    solution.parent.mkdir(parents=True)
    solution.write_text(json.dumps(notebook), encoding='utf-8')
    converters.generate(layout, ASSIGNMENT, layout.notebooks, database=False)
    release = read_release(layout.release(ASSIGNMENT))
    for student, text in answers.items():
        path = submitted(layout) / student / ASSIGNMENT / name
        path.parent.mkdir(parents=True)
        path.write_text(json.dumps(_answered(release, text)), encoding='utf-8')
    return layout


def submitted(layout: Layout) -> Path:
    """Return the folder of the submissions, outside the work folder, which each run deletes."""
    return layout.root / 'handed_in'


def _left_out(folder: str, names: list[str]) -> list[str]:
    """Return the names not to copy: results of grading, and the other exams."""
    if Path(folder).name in ('visible', 'hidden'):
        return [name for name in names if Path(name).stem not in ('__init__', EXAM)]
    return [name for name in names if name == '_work']


def replace_once(path: Path, old: str, new: str) -> None:
    """
    Replace a string in a copied file.

    :raises RuntimeError: if the file does not contain the string exactly once
    """
    text = path.read_text(encoding='utf-8')
    if text.count(old) != 1:
        raise RuntimeError(f'{path.name}: expected {old} once; adapt this benchmark.')
    path.write_text(text.replace(old, new), encoding='utf-8')


def _answered(release: dict[str, Any], text: str) -> dict[str, Any]:
    """Return the release with an answer in its answer cell."""
    notebook = copy.deepcopy(release)
    for cell in notebook['cells']:
        if marks_of(cell).get('grade_id') == EXAM:
            cell['source'] = f'%%node temp_publisher\n{text}'
    return notebook


@dataclass(frozen=True)
class Graded:
    """
    The outcome of one command of the grader.

    :param results: its output with ``--json``
    :param wall_s: real time of the complete command [s]
    :param running_s: the time during which programs ran [s], 0 if the command does not print it
    """

    results: list[Any]
    wall_s: float
    running_s: float

    @property
    def checks(self) -> dict[str, dict[str, Mapping[str, Any]]]:
        """Return the verdicts by student and check."""
        return {
            result['student']: {
                check['check']: check for exam in result['exams'] for check in exam['checks']
            }
            for result in self.results
        }

    @property
    def points(self) -> dict[str, dict[str, float]]:
        """Return the points by student and check."""
        return {
            student: {name: check['points'] for name, check in checks.items()}
            for student, checks in self.checks.items()
        }


def start(
    layout: Layout, *words: str, before: Sequence[str] = (), **variables: str
) -> subprocess.Popen[str]:
    """
    Start a command of the copied grader on the class.

    :param words: the command with its options
    :param before: prefix of the command line
    :param variables: further environment variables
    """
    command = [*before, sys.executable, '-m', 'autograder', *words]
    return subprocess.Popen(
        [*command, '--json', '--submitted', str(submitted(layout))],
        cwd=layout.root,  # Python searches here first, so the copy of the grader runs
        env={**os.environ, 'COURSE_SECRET': 'benchmark', **variables},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def finish(
    process: subprocess.Popen[str], accepted: Sequence[int] = (0,), timeout: float | None = None
) -> Graded:
    """
    Wait for a command from :func:`start`.

    :param accepted: the accepted exit codes
    :param timeout: how long to wait [s]
    :raises RuntimeError: with the command's output, if its exit code is not expected
    :raises subprocess.TimeoutExpired: if it is still running
    """
    began = time.monotonic()
    said, errors = process.communicate(timeout=timeout)
    wall_s = time.monotonic() - began
    if process.returncode not in accepted or not said:
        raise RuntimeError(f'autograder ended with {process.returncode}:\n{errors}')
    running = re.search(r'of which runs took ([\d.]+) s', errors)
    return Graded(json.loads(said), wall_s, float(running[1]) if running else 0.0)


def grade(layout: Layout, *options: str) -> Graded:
    """
    Grade the class with the complete command, as if for the first time.

    :raises RuntimeError: with the command's output, if it produces no verdicts
    """
    shutil.rmtree(layout.work, ignore_errors=True)
    return finish(start(layout, 'grade', *options))
