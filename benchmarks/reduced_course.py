"""
A copy of this course with one lesson part in it, so that one exam can be measured alone.

The grader in the copy is the course's own, file by file; only the other exams are left out and
the notebook is cut down to the publisher.  It has a gradebook and recordings of its own, so a
measurement neither reads nor changes those of the course.
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
    One ``python -m autograder grade`` of the class.

    :param wall_s: the whole command [s]
    :param results: what it printed with ``--json``, by student
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
    Make the copy and hand in the answers.

    :param root: an empty folder
    :param answers: by student, the text of ``temp_publisher.py``
    :param seconds: virtual seconds of the exam
    :param more: further checks, as text of the exam's module
    :param more_points: what they give
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
    """Return where the answers lie: not in the work folder, which each run starts without."""
    return layout.root / 'handed_in'


def _left_out(folder: str, names: list[str]) -> list[str]:
    """Leave out what grading has written, and the other exams."""
    if Path(folder).name in ('visible', 'hidden'):
        return [name for name in names if name not in ('__init__.py', f'{EXAM}.py')]
    return [name for name in names if name == '_work']


def _set_window(path: Path, seconds: int) -> None:
    """Set how many seconds the copied exam lasts."""
    text = path.read_text(encoding='utf-8')
    if text.count('seconds=60') != 1:
        raise RuntimeError(f'{path.name}: expected seconds=60 once; adapt this benchmark.')
    path.write_text(text.replace('seconds=60', f'seconds={seconds}'), encoding='utf-8')


def _answered(release: dict[str, Any], text: str) -> dict[str, Any]:
    """Return the release with an answer in it."""
    notebook = copy.deepcopy(release)
    for cell in notebook['cells']:
        if marks_of(cell).get('grade_id') == EXAM:
            cell['source'] = f'%%node temp_publisher\n{text}'
    return notebook


def grade(layout: Layout, jobs: int) -> ProjectRun:
    """
    Grade the class with the whole command, as if for the first time.

    :param jobs: runs at a time
    :raises RuntimeError: with the command's own words, if it gives no verdicts
    """
    shutil.rmtree(layout.work, ignore_errors=True)
    command = [sys.executable, '-m', 'autograder', 'grade', '--fresh', '--json']
    command += ['--submitted', str(submitted(layout)), '--jobs', str(jobs)]
    began = time.monotonic()
    done = subprocess.run(
        command,
        cwd=layout.root,  # where Python looks for modules first: the copy is what runs
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
