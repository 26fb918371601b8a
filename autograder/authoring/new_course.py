"""
Begin another course, or another exercise in one: files that work at once and are then edited.

The texts are in ``skeleton/``; ``$$NAME`` in them is filled in.
"""

from __future__ import annotations

from collections.abc import Mapping
import json
from pathlib import Path
import re
import shutil
from string import Template
import tempfile
from typing import Any

from autograder.errors import GraderError
from autograder.files import keep
from autograder.layout import FILE, Layout

SKELETON = Path(__file__).parent / 'skeleton'
PROJECT = Path(__file__).resolve().parents[2]
NAME = re.compile(r'[a-z][a-z0-9_]{1,40}')
LESSON = re.compile(r'\d\d_[a-z][a-z0-9_]{1,40}')


def new_course(folder: Path) -> list[Path]:
    """
    Make the folder of a course: its facts, nbgrader's settings, a message package, no exams yet.

    :param folder: new or empty; its name is that of the course
    :returns: the files, from the folder
    :raises GraderError: if there is something in it, or its name is none for a ROS package
    """
    folder = folder.resolve()
    name = folder.name.replace('-', '_')
    if not NAME.fullmatch(name):
        raise GraderError(f'{folder.name}: expected small letters, digits and _.', 'Rename it.')
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise GraderError(f'{folder}: expected no such folder, or an empty one.')
    package = f'{name}_msgs'
    words = {'course': name, 'package': package}
    files = {FILE: _filled('course.toml', words), '.gitignore': '/_work/\n/.venv*\n'}
    for source in sorted((SKELETON / 'package').rglob('*.*')):
        inside = source.relative_to(SKELETON)
        files[f'{package}/{inside.relative_to("package")}'] = _filled(str(inside), words)
    for part in ('', 'visible/', 'hidden/'):
        files[f'exams/{part}__init__.py'] = ''
    files['nbgrader_config.py'] = (PROJECT / 'nbgrader_config.py').read_text(encoding='utf-8')
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix='.new_course_') as aside:
        Path(aside).chmod(0o755)  # the sandbox's user reads it
        for path, text in files.items():
            keep(Path(aside, path), text.encode())
        shutil.copytree(aside, folder, dirs_exist_ok=True)
    return [Path(path) for path in files]


def new_exam(layout: Layout, name: str, lesson: str) -> list[Path]:
    """
    Make an exercise that works: a lesson with its node and its check cell, and both exams.

    :param name: of the exam, the node and its file
    :param lesson: folder of the lesson, ``01_points``
    :returns: the files, from the course
    :raises GraderError: if a name is none, or a file is there already
    """
    if not NAME.fullmatch(name):
        raise GraderError(f'{name}: expected small letters, digits and _.')
    if not LESSON.fullmatch(lesson):
        raise GraderError(f'{lesson}: expected a number and a name, such as 01_points.')
    words = {
        'name': name,
        'lesson': lesson,
        'package': layout.facts.package,
        'title': name.replace('_', ' ').capitalize(),
        'class_name': name.title().replace('_', ''),
    }
    exams = layout.exams.relative_to(layout.root)
    hidden = _filled('hidden.txt', words).replace('exams.', f'{layout.facts.exams}.')
    files = {
        Path('solutions', lesson, f'{lesson[3:]}.ipynb'): _notebook(words),
        exams / 'visible' / f'{name}.py': _filled('visible.txt', words),
        exams / 'hidden' / f'{name}.py': hidden,
    }
    for path in files:
        if (layout.root / path).exists():
            raise GraderError(f'{path}: it is there already.', 'Choose another name.')
    for path, text in files.items():
        keep(layout.root / path, text.encode())
    return list(files)


def _filled(name: str, words: Mapping[str, str]) -> str:
    return Template((SKELETON / name).read_text(encoding='utf-8')).substitute(words)


def _notebook(words: Mapping[str, str]) -> str:
    """Return a lesson: text, import of ``check``, the answer with its solution, the check."""
    name = words['name']
    cells = [
        _cell('text', _filled('lesson.txt', words), cell_type='markdown'),
        _cell('start', 'from roslab import check'),
        _cell(name, _filled('node.txt', words), grade=False),
        _cell(f'check_{name}', f"check('{name}')", grade=True, points=6),
    ]
    kernel = {'display_name': 'ROS 2 Jazzy', 'language': 'python', 'name': 'ros2_jazzy'}
    whole = {'cells': cells, 'metadata': {'kernelspec': kernel}}
    return json.dumps({**whole, 'nbformat': 4, 'nbformat_minor': 5}, indent=1) + '\n'


def _cell(cell_id: str, source: str, cell_type: str = 'code', **marks: Any) -> dict[str, Any]:
    """
    Return a cell.

    :param marks: ``grade`` for a cell that nbgrader knows, and its ``points``
    """
    cell: dict[str, Any] = {
        'cell_type': cell_type,
        'id': cell_id.replace('_', '-'),
        'metadata': {},
        'source': source.rstrip('\n'),
    }
    if cell_type == 'code':
        cell |= {'outputs': [], 'execution_count': None}
    if marks:
        graded = marks['grade']
        more = {'solution': not graded, 'locked': graded, 'task': False, 'schema_version': 3}
        cell['metadata'] = {'nbgrader': {'grade_id': cell_id, **more, **marks}}
    return cell
