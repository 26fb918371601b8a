"""
Make a course as nbgrader's documentation recommends, and grade it with stock nbgrader.

The tests are hidden in the notebook's grade cells and run in the student's kernel, in real time,
one submission after the other.  All files are in a temporary folder.
"""

from collections.abc import Mapping
import os
from pathlib import Path
import re
import subprocess
import sys
import time

import nbformat
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_notebook

from environment.ros import ros_environment

ASSIGNMENT = 'temperature'
NOTEBOOK = 'publisher.ipynb'
ANSWER = 'temperature_publisher'
CELLS = Path(__file__).with_name('stock_cells.py')
CELL_LINE = re.compile(r'^# %% (?P<name>\w+)(?: (?P<points>\d+))?\n', re.MULTILINE)
LAST_BLOCK = re.compile(r"^if __name__ == '__main__':\n(?:[ \t].*\n?|\n)*\Z", re.MULTILINE)
CONFIG = """\
c = get_config()
c.CourseDirectory.course_id = 'stock'
c.Execute.timeout = {timeout_s}
"""


def build(root: Path, answers: Mapping[str, str], seconds: int) -> None:
    """
    Make the course and submit the answers.

    :param root: an empty folder
    :param answers: text of a node file, by student
    :param seconds: how long the tests listen [s]
    """
    # By default, nbgrader stops a cell after 30 s.
    config = CONFIG.format(timeout_s=seconds + 60)
    (root / 'nbgrader_config.py').write_text(config, encoding='utf-8')
    source = root / 'source' / ASSIGNMENT / NOTEBOOK
    source.parent.mkdir(parents=True)
    nbformat.write(_source_notebook(seconds), source)
    _nbgrader(root, 'generate_assignment', ASSIGNMENT, '--create')
    release = nbformat.read(root / 'release' / ASSIGNMENT / NOTEBOOK, as_version=4)
    for student, text in answers.items():
        path = root / 'submitted' / student / ASSIGNMENT / NOTEBOOK
        path.parent.mkdir(parents=True)
        nbformat.write(_answered(release, text), path)


def _source_notebook(seconds: int) -> NotebookNode:
    """Return the instructor's notebook."""
    text = CELLS.read_text(encoding='utf-8').replace('WINDOW_S = 60', f'WINDOW_S = {seconds}')
    found = list(CELL_LINE.finditer(text))
    ends = [match.start() for match in found[1:]] + [len(text)]
    cells = []
    for match, end in zip(found, ends):
        source = text[match.end() : end].strip('\n')
        points = match['points']
        if points:
            source = f'### BEGIN HIDDEN TESTS\n{source}\n### END HIDDEN TESTS'
        cell = new_code_cell(source)
        cell.id = match['name'].replace('_', '-')
        cell.metadata['nbgrader'] = {
            'schema_version': 3,
            'grade_id': match['name'],
            'grade': bool(points),
            'solution': match['name'] == ANSWER,
            'locked': match['name'] != ANSWER,
            'task': False,
            **({'points': float(points)} if points else {}),
        }
        cells.append(cell)
    # The course's kernel logs to standard output: a log line on stderr would give 0 points.
    kernel = {'name': 'ros2_jazzy', 'display_name': 'ROS 2 Jazzy', 'language': 'python'}
    return new_notebook(cells=cells, metadata={'kernelspec': kernel})


def _answered(release: NotebookNode, text: str) -> NotebookNode:
    """Return the release with an answer, without ``if __name__``, which is true in a kernel."""
    notebook = nbformat.from_dict(release)
    for cell in notebook.cells:
        if cell.metadata.get('nbgrader', {}).get('grade_id') == ANSWER:
            cell.source = LAST_BLOCK.sub('', text)
    return notebook


def autograde(root: Path) -> float:
    """
    Grade the class with ``nbgrader autograde``, and return the time of the whole command [s].

    :param root: folder created by :func:`build`
    """
    began = time.monotonic()
    _nbgrader(root, 'autograde', ASSIGNMENT, '--force')
    wall_s = time.monotonic() - began
    _check_set_up(root)
    return wall_s


def _check_set_up(root: Path) -> None:
    """
    Check that the kernels work: otherwise every test fails early and the times are too short.

    :raises RuntimeError: if a set-up cell failed, with its output
    """
    for path in root.glob(f'autograded/*/{ASSIGNMENT}/{NOTEBOOK}'):
        for output in nbformat.read(path, as_version=4).cells[0].outputs:
            if output.output_type == 'error':
                said = f'{output.ename}: {output.evalue}'
                raise RuntimeError(f'{path}: the set-up cell failed with {said}')


def points(database: Path, assignment: str) -> dict[str, dict[str, float]]:
    """
    Return the points in a gradebook for the check cells of an assignment.

    :returns: points by student and grade id
    """
    from nbgrader.api import Gradebook

    found: dict[str, dict[str, float]] = {}
    with Gradebook(f'sqlite:///{database}') as gradebook:
        for submission in gradebook.assignment_submissions(assignment):
            grades = [grade for book in submission.notebooks for grade in book.grades]
            found[submission.student.id] = {grade.name: float(grade.score) for grade in grades}
    return found


def _nbgrader(root: Path, *arguments: str) -> None:
    """
    Run an nbgrader command.

    :raises RuntimeError: if the command fails, with the last lines of its output
    """
    done = subprocess.run(
        [sys.executable, '-m', 'nbgrader', *arguments],
        cwd=root,
        env=_variables(root),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode != 0:
        last = '\n'.join(done.stdout.splitlines()[-30:])
        raise RuntimeError(f'nbgrader {arguments[0]} failed:\n{last}')


def _variables(root: Path) -> dict[str, str]:
    """Return nbgrader's environment, without the user's settings and with one domain per class."""
    variables = {**os.environ, **ros_environment().variables}
    # Other ROS programs on this machine could use the same domain, but few use 215 to 232.
    variables['ROS_DOMAIN_ID'] = str(215 + os.getpid() % 18)
    for name in ('HOME', 'JUPYTER_CONFIG_DIR', 'JUPYTER_DATA_DIR', 'IPYTHONDIR', 'ROS_LOG_DIR'):
        folder = root / 'home' / name.lower()
        folder.mkdir(parents=True, exist_ok=True)
        variables[name] = str(folder)
    return variables
