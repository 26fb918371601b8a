"""
Make a copy of this course with a single lesson part, to measure one exam alone.

The copy contains an unchanged copy of the grader; only the other exams are missing, and the
notebook contains only the publisher.  The copy has a separate gradebook and separate recordings,
so a measurement neither reads nor changes those of the course.
"""

from __future__ import annotations

from collections.abc import Mapping
import copy
from dataclasses import dataclass
import json
import os
from pathlib import Path
import shutil
import subprocess
import sys
import time
from typing import Any

from autograder.gradebook import converters
from autograder.layout import Layout
from autograder.submission.notebook import marks_of, read_release
from benchmarks.submissions import ASSIGNMENT, EXAM

KEPT_CELLS = ('spec_publisher', EXAM, f'check_{EXAM}')


@dataclass(frozen=True)
class ProjectRun:
    """
    The outcome of one ``python -m autograder grade`` of the class.

    :param wall_s: real time of the complete command [s]
    :param results: the output with ``--json``, by student
    """

    wall_s: float
    results: Mapping[str, Mapping[str, Any]]

    def points(self) -> dict[str, dict[str, float]]:
        """Return the points by student and check."""
        return {
            student: {
                check['check']: check['points']
                for exam in result['exams']
                for check in exam['checks']
            }
            for student, result in self.results.items()
        }


def build(
    root: Path, answers: Mapping[str, str], seconds: int, more: str = '', more_points: float = 0
) -> Layout:
    """
    Make the copy and submit the answers.

    :param root: an empty folder
    :param answers: text of ``temp_publisher.py``, by student
    :param seconds: duration of the exam [virtual s]
    :param more: code of additional checks, appended to the exam's module
    :param more_points: points of the additional checks
    """
    course, layout = Layout.here(), Layout(root)
    shutil.copytree(course.root / 'autograder', root / 'autograder', ignore=_left_out)
    for name in ('course.toml', 'nbgrader_config.py'):
        shutil.copy2(course.root / name, root)
    exam = root / 'autograder' / 'exams' / 'hidden' / f'{EXAM}.py'
    _set_window(exam, seconds)
    exam.write_text(exam.read_text(encoding='utf-8') + more, encoding='utf-8')
    name = course.release(ASSIGNMENT).name
    notebook = read_release(course.solutions / ASSIGNMENT / name)
    notebook['cells'] = [
        cell for cell in notebook['cells'] if marks_of(cell).get('grade_id') in KEPT_CELLS
    ]
    for cell in notebook['cells']:
        if marks_of(cell).get('grade_id') == f'check_{EXAM}':
            cell['metadata']['nbgrader']['points'] += more_points
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
        return [name for name in names if name not in ('__init__.py', f'{EXAM}.py')]
    return [name for name in names if name == '_work']


def _set_window(path: Path, seconds: int) -> None:
    """Set the duration of the copied exam."""
    text = path.read_text(encoding='utf-8')
    if text.count('seconds=WATCH_S') != 1:
        raise RuntimeError(f'{path.name}: expected seconds=WATCH_S once; adapt this benchmark.')
    path.write_text(text.replace('seconds=WATCH_S', f'seconds={seconds}'), encoding='utf-8')


def _answered(release: dict[str, Any], text: str) -> dict[str, Any]:
    """Return the release with an answer in its answer cell."""
    notebook = copy.deepcopy(release)
    for cell in notebook['cells']:
        if marks_of(cell).get('grade_id') == EXAM:
            cell['source'] = f'%%node temp_publisher\n{text}'
    return notebook


def grade(layout: Layout, jobs: int) -> ProjectRun:
    """
    Grade the class with the complete command, as if for the first time.

    :param jobs: number of concurrent runs
    :raises RuntimeError: with the command's output, if it produces no verdicts
    """
    shutil.rmtree(layout.work, ignore_errors=True)
    command = [sys.executable, '-m', 'autograder', 'grade', '--fresh', '--json']
    command += ['--submitted', str(submitted(layout)), '--jobs', str(jobs)]
    began = time.monotonic()
    done = subprocess.run(
        command,
        cwd=layout.root,  # Python searches here first, so the copy of the grader runs
        env={**os.environ, 'COURSE_SECRET': 'benchmark'},
        capture_output=True,
        text=True,
        check=False,
    )
    wall_s = time.monotonic() - began
    if done.returncode != 0:
        raise RuntimeError(f'autograder grade ended with {done.returncode}:\n{done.stderr}')
    results = {result['student']: result for result in json.loads(done.stdout)}
    return ProjectRun(wall_s, results)
