"""
Create a course, or an exercise in a course, as working files for the author to edit.

The templates are in ``skeleton/``; placeholders such as ``$name`` in them are replaced.
"""

from collections.abc import Mapping
import json
from pathlib import Path
import re
import shutil
from string import Template
import tempfile

from autograder.errors import GraderError
from autograder.files import files_below, write_atomically
from autograder.layout import Layout, lesson_files
from autograder.submission.notebook import is_check, read_release
from environment.install_files import KERNEL_NAME, KERNEL_TITLE
from environment.places import FILE

SKELETON = Path(__file__).parent / 'skeleton'
NAME = re.compile(r'[a-z][a-z0-9_]{1,40}')
LESSON = re.compile(r'\d\d_[a-z][a-z0-9_]{1,40}')


def new_course(folder: Path) -> list[Path]:
    """
    Create the folder of a course with ``course.toml``, nbgrader's settings and a message package.

    :param folder: a new or empty folder; its name becomes the name of the course
    :raises GraderError: if the folder is not empty, or its name is not valid for a ROS package
    """
    folder = folder.resolve()
    name = folder.name.replace('-', '_')
    if not NAME.fullmatch(name):
        raise GraderError(
            f'{folder.name}: expected a lower-case letter, then such letters, digits or hyphens.',
            'Rename it.',
        )
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise GraderError(f'{folder}: this folder exists and is not empty.')
    package = f'{name}_msgs'
    words = {'course': name, 'package': package}
    files = {FILE: _filled('course.toml', words), '.gitignore': '/_work/\n/.venv*\n'}
    for inside, _ in sorted(files_below(SKELETON, 'package', set())):
        files[f'{package}{inside.removeprefix("package")}'] = _filled(inside, words)
    for part in ('', 'visible/', 'hidden/'):
        files[f'exams/{part}__init__.py'] = ''
    files['nbgrader_config.py'] = _filled('nbgrader_config.txt', {})
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix='.new_course_') as aside:
        Path(aside).chmod(0o755)  # The user inside the sandbox must be able to read the folder.
        for path, text in files.items():
            write_atomically(Path(aside, path), text.encode())
        shutil.copytree(aside, folder, dirs_exist_ok=True)
    return [Path(path) for path in files]


def new_exam(layout: Layout, name: str, lesson: str) -> list[Path]:
    """
    Create a working exercise: a text, a node and a check cell in a lesson, and both exams.

    :param lesson: folder of the lesson, such as ``01_points``, which may have other exercises
    :raises GraderError: if a name is not valid, or an exam of this name exists
    """
    if not NAME.fullmatch(name):
        raise GraderError(f'{name}: expected a lower-case letter, then such letters, digits or _.')
    if not LESSON.fullmatch(lesson):
        raise GraderError(f'{lesson}: expected a number and a name, such as 01_points.')
    words = {
        'name': name,
        'lesson': lesson,
        'package': layout.facts.package,
        'title': name.replace('_', ' ').capitalize(),
        'class_name': name.title().replace('_', ''),
        'cell': name.replace('_', '-'),
        'kernel': KERNEL_NAME,
        'kernel_title': KERNEL_TITLE,
    }
    there = [path for path in lesson_files(layout.solutions) if path.parent.name == lesson]
    try:
        cells = read_release(there[0])['cells'] if there else []
    except (OSError, ValueError) as error:
        raise GraderError(f'{there[0]}: cannot be read: {error}.') from error
    words['part'] = str(1 + sum(map(is_check, cells)))
    files = {
        Path('exams', 'visible', f'{name}.py'): _filled('visible.txt', words),
        Path('exams', 'hidden', f'{name}.py'): _filled('hidden.txt', words),
    }
    for path in files:
        if (layout.root / path).exists():
            raise GraderError(f'{path}: this file already exists.', 'Try: a different name')
    packages = [Path('exams', part, '__init__.py') for part in ('', 'visible', 'hidden')]
    files |= {path: '' for path in packages if not (layout.root / path).exists()}
    notebook = there[0] if there else layout.solutions / lesson / f'{lesson[3:]}.ipynb'
    exercise = _filled('notebook.txt', words)
    files[notebook.relative_to(layout.root)] = _appended(there[0], exercise) if there else exercise
    for path, text in files.items():
        write_atomically(layout.root / path, text.encode())
    return list(files)


def _appended(lesson: Path, exercise: str) -> str:
    """Return a lesson with the text, the node and the check cell of one more exercise."""
    notebook = json.loads(lesson.read_text(encoding='utf-8'))
    text, _, answer, check = json.loads(exercise)['cells']
    added = [{**text, 'id': f'text-{answer["id"]}'}, answer, check]
    if notebook.get('nbformat_minor', 0) < 5:  # cells have ids since version 4.5 of the format
        added = [{name: one for name, one in cell.items() if name != 'id'} for cell in added]
    notebook['cells'] += added
    return json.dumps(notebook, indent=1, ensure_ascii=False) + '\n'


def _filled(name: str, words: Mapping[str, str]) -> str:
    return Template((SKELETON / name).read_text(encoding='utf-8')).substitute(words)
