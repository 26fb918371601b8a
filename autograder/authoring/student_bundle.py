"""
List the files that students receive, and pack them into a zip file.

Students receive only files that are listed here, so a new file is not released by mistake.
"""

from pathlib import Path
import re

from autograder.exam.catalog import for_assignment, load
from autograder.explaining.worked_answers import encoded, FOLDER
from autograder.files import files_below, write_atomically, zip_bytes, zip_content
from autograder.layout import Layout, lesson_files
from autograder.submission.notebook import answer_cells, read_release
from environment import packed_package
from environment.places import PROJECT

ALLOWED = (
    'drawing/',
    'environment/',
    'roslab/',
    'roslab/ros2/LICENSE',
    '.vscode/extensions.json',
    # Files that check(...) needs: the visible exams, the judge and the sandbox.
    'autograder/__init__.py',
    'autograder/clock/',
    'autograder/commands/__init__.py',
    'autograder/commands/check.py',
    'autograder/errors.py',
    'autograder/exam/',
    'autograder/explaining/',
    'autograder/fastdds.xml',
    'autograder/files.py',
    'autograder/grading/__init__.py',
    'autograder/grading/examine.py',
    'autograder/inside/',
    'autograder/judging/',
    'autograder/layout.py',
    'autograder/probe/',
    'autograder/recording.py',
    'autograder/results.py',
    'autograder/runs/',
    'autograder/sandboxes/',
    'autograder/simulated.py',
    'autograder/simulation/',
    'autograder/submission/',
    # The code that GitHub Actions runs on every push.
    'autograder/workflow/',
)
"""Files and folders of this project that students receive; folders end with a slash."""
AT_THE_TOP = Path(__file__).parent / 'for_students'
"""Folder of the files that are at the top level of the students' copy."""
UNDER_ANOTHER_NAME = {'README.md': 'docs/students.md'}
"""Files with a different name in the students' copy: the project's README is for instructors."""
NO_PARTS = {'hidden', '__pycache__', '.ipynb_checkpoints', 'ros_ws', 'build', 'install', 'log'}
TOP = 'ros2-course'
MARK = re.compile(r'^ *### (?:BEGIN|END) SOLUTION *\n?', re.MULTILINE)


def bundled_files(layout: Layout) -> dict[str, Path]:
    """Return the files that students receive, by their name in the students' copy."""
    package = layout.facts.package
    own = ['course.toml', 'notebooks/', 'exams/']
    own += [f'{package}/{folder}/' for folder in ('config', 'launch') if package]
    parts = [*((layout.root, one) for one in own), *((PROJECT, one) for one in ALLOWED)]
    parts += [(AT_THE_TOP, path.name) for path in AT_THE_TOP.iterdir()]
    found = {name: layout.root / source for name, source in UNDER_ANOTHER_NAME.items()}
    for root, part in parts:
        found.update(files_below(root, part, NO_PARTS))
    return {name: path for name, path in found.items() if path.is_file()}


def pack(layout: Layout, bundle: Path, answers: bool = False) -> int:
    """
    Write the zip file for students atomically; the same course gives the same bytes.

    :param answers: whether to include the worked answers, which students can then open
    """
    files = {name: zip_content(path) for name, path in bundled_files(layout).items()}
    if package := layout.facts.package:
        packed = packed_package.pack(layout.root / package)
        files[f'{package}/{packed_package.FILE}'] = packed, 0o644
    if answers:
        files |= {name: (data, 0o644) for name, data in answer_files(layout).items()}
    write_atomically(bundle, zip_bytes({f'{TOP}/{name}': file for name, file in files.items()}))
    return len(files)


def answer_files(layout: Layout) -> dict[str, bytes]:
    """
    Return the worked answers of each lesson with exercises, by file name in the students' copy.

    An exercise has a worked answer only if its visible checks give all points.  Other exercises,
    such as the questions of lesson 09, pass with wrong answers: a worked answer would be a key.
    """
    found = {}
    for path in lesson_files(layout.solutions):
        lesson = path.parent.name
        cells = answer_cells(read_release(path))
        texts = {name: MARK.sub('', cell['source']).strip() for name, cell in cells.items()}
        answers = {
            exam.name: '\n\n\n'.join(texts[one] for one in exam.cells)
            for exam in for_assignment(lesson)
            if exam.max_points == load(exam.name, hidden=False).max_points
        }
        if answers:
            found[f'{FOLDER}/{lesson}.txt'] = encoded(answers)
    return found
