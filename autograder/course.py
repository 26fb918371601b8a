"""
The course as a whole: ``python -m autograder.course check | release``.

``check`` proves that what is committed fits together; ``release`` generates ``notebooks/`` and
packs what students receive.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
import io
from pathlib import Path
import re
import sys
import tempfile
from typing import TYPE_CHECKING
import zipfile

from autograder.errors import ExamInvalid, GraderError
from autograder.handed_in.extract import CHECK_PREFIX
from autograder.handed_in.submission import marks_of, Notebook, read_release
from autograder.layout import Layout
from autograder.portions import portions
from autograder.runs.recording import keep

if TYPE_CHECKING:
    from autograder.judging.exam import Exam

CHECK_CELL = re.compile(r"^check\((['\"])(?P<exam>\w+)\1\)$")
BUNDLED = (
    'environment.md',
    'LICENSE',
    'Makefile',
    'pyproject.toml',
    'environment',
    'autograder',
    'drawing',
    'roslab',
    'temp_monitor_pkg',
    'notebooks',
)
"""What students receive; everything that is not named here stays."""
UNDER_ANOTHER_NAME = {'README.md': 'docs/students.md'}
"""What students receive besides: the page about the whole project would lead them astray."""
WITHHELD = (
    'autograder/exams/hidden',
    'autograder/_work',
    'autograder/course.py',
    'autograder/portions.py',
    'autograder/gradebook/nbgrader_plugin.py',
    'autograder/gradebook/converters.py',
    'autograder/gradebook/record.py',
    'autograder/sample_class.py',
)
NO_PARTS = {'__pycache__', '.ipynb_checkpoints', 'ros_ws', 'build', 'install', 'log'}


# -- check ----------------------------------------------------------------------------------


def check(layout: Layout, exams: Sequence[Exam] | None = None) -> list[str]:
    """
    Return what does not fit together, one line each; empty if all is well.

    :param exams: instead of the course's own, for tests
    """
    found = [*drift(layout)]
    seen: dict[str, str] = {}
    for path in notebook_files(layout):
        where = path.relative_to(layout.root).as_posix()
        notebook = read_release(path)
        found += stored_outputs(notebook, where)
        if path.is_relative_to(layout.solutions):
            found += repeated_ids(notebook, where, seen)
            found += unfit_checks(notebook, where, path.parent.name, exams)
            found += [f'{where}: {line}' for line in portions(notebook).problems()]
    if exams is None:
        found += unfit_exams(layout)
    return found


def unfit_exams(layout: Layout) -> Iterator[str]:
    """Yield what is wrong with the exams themselves: types, fields, two versions that differ."""
    from autograder.exams import for_assignment
    from autograder.judging.exam_mistakes import ament_prefixes, mistakes_of

    prefixes = ament_prefixes()
    for assignment in layout.assignments():
        for exam in for_assignment(assignment):
            yield from mistakes_of(exam, prefixes, layout.notebooks)


def notebook_files(layout: Layout) -> Iterator[Path]:
    """Yield the notebooks of the course."""
    for folder in (layout.solutions, layout.notebooks):
        yield from sorted(folder.glob('*/*.ipynb'))


def drift(layout: Layout) -> Iterator[str]:
    """Yield the generated files that differ from what the solutions give."""
    from autograder.gradebook import converters

    assignments = sorted({path.parent.name for path in layout.solutions.glob('*/*.ipynb')})
    with tempfile.TemporaryDirectory(prefix='release_') as folder:
        fresh = Path(folder)
        for assignment in assignments:
            converters.generate(layout, assignment, fresh, database=False)
        wanted = _contents(fresh)
    there = _contents(layout.notebooks)
    for name in sorted(wanted.keys() | there.keys()):
        if wanted.get(name) != there.get(name):
            got = 'another text' if name in wanted and name in there else 'none'
            expected = 'what solutions/ gives' if name in wanted else 'no such file'
            got = got if name in wanted else 'a file'
            yield f'notebooks/{name}: expected {expected}, got {got}. Try: make release.'


def _contents(folder: Path) -> dict[str, bytes]:
    """Return all files of a folder but what a learner makes in it."""
    if not folder.is_dir():
        return {}
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob('*')
        if path.is_file() and not NO_PARTS & set(path.relative_to(folder).parts)
    }


def stored_outputs(notebook: Notebook, where: str) -> Iterator[str]:
    """Yield the cells that keep outputs or execution counts."""
    for number, cell in enumerate(notebook['cells'], 1):
        if cell.get('outputs') or cell.get('execution_count') is not None:
            yield f'{where}, cell {number}: expected no stored output. Try: clear all outputs.'


def repeated_ids(notebook: Notebook, where: str, seen: dict[str, str]) -> Iterator[str]:
    """Yield grade ids that are used twice in the course; fill ``seen``."""
    for cell in notebook['cells']:
        grade_id = marks_of(cell).get('grade_id')
        if grade_id in seen:
            yield f'{where}, cell {grade_id}: this grade id is also used in {seen[grade_id]}.'
        elif grade_id:
            seen[grade_id] = where


def unfit_checks(
    notebook: Notebook, where: str, assignment: str, exams: Sequence[Exam] | None
) -> Iterator[str]:
    """Yield check cells and exams that do not belong together."""
    if exams is None:
        from autograder.exams import for_assignment

        exams = for_assignment(assignment)
    known = {exam.name: exam for exam in exams}
    answers: set[str] = set()
    for cell in notebook['cells']:
        marks = marks_of(cell)
        if marks.get('solution'):
            answers.add(marks['grade_id'])
        elif marks.get('grade') and cell['cell_type'] == 'code':
            yield from _unfit_check(cell, f'{where}, cell {marks["grade_id"]}', known, answers)
    for name in known:
        yield f'{where}: the exam {name} has no check cell above which its answers lie.'


def _unfit_check(
    cell: Notebook, where: str, known: dict[str, Exam], answers: set[str]
) -> Iterator[str]:
    """Yield what is wrong with one check cell; take its exam off the list."""
    marks = marks_of(cell)
    match = CHECK_CELL.match(cell['source'].strip())
    name = match['exam'] if match else ''
    if marks['grade_id'] != f'{CHECK_PREFIX}{name}':
        expected = f"check('{marks['grade_id'].removeprefix(CHECK_PREFIX)}')"
        yield f'{where}: expected the one line {expected}, got {cell["source"][:60]!r}.'
        return
    exam = known.pop(name, None)
    if exam is None:
        yield f'{where}: there is no exam {name} for this assignment.'
        return
    if abs(exam.max_points - float(marks['points'])) > 1e-9:
        yield f'{where}: {marks["points"]} points, but the exam gives {exam.max_points:g}.'
    for grade_id in sorted(set(exam.cells) - answers):
        yield f'{where}: the exam needs the answer {grade_id}, which is not above it.'


# -- release --------------------------------------------------------------------------------


def regenerate(layout: Layout) -> tuple[str, ...]:
    """
    Generate ``notebooks/`` from ``solutions/``.

    :returns: the assignments
    :raises GraderError: with nbgrader's own words
    """
    from autograder.gradebook import converters

    assignments = sorted({path.parent.name for path in layout.solutions.glob('*/*.ipynb')})
    if not assignments:
        raise GraderError(f'{layout.solutions}: expected ASSIGNMENT/NOTEBOOK.ipynb, got none.')
    for assignment in assignments:
        converters.generate(layout, assignment, layout.notebooks, database=False)
    return tuple(assignments)


def pack(layout: Layout, bundle: Path) -> int:
    """
    Write the zip file that students receive, whole; the same course gives the same bytes.

    :returns: number of files
    """
    files, made = bundled_files(layout), io.BytesIO()
    with zipfile.ZipFile(made, 'w', zipfile.ZIP_DEFLATED) as archive:
        for name, path in sorted(files.items()):
            entry = zipfile.ZipInfo(f'ros2-course/{name}', date_time=(2024, 1, 1, 0, 0, 0))
            entry.external_attr = (0o755 if path.stat().st_mode & 0o100 else 0o644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, path.read_bytes())
    keep(bundle, made.getvalue())
    return len(files)


def bundled_files(layout: Layout) -> dict[str, Path]:
    """Return what students receive: name in their copy -> file of the course."""
    renamed = {name: layout.root / source for name, source in UNDER_ANOTHER_NAME.items()}
    found = {name: path for name, path in renamed.items() if path.is_file()}
    for top in BUNDLED:
        start = layout.root / top
        for path in [start] if start.is_file() else start.rglob('*'):
            name = path.relative_to(layout.root).as_posix()
            withheld = any(name == one or name.startswith(f'{one}/') for one in WITHHELD)
            made = bool(NO_PARTS & set(path.relative_to(layout.root).parts))
            if path.is_file() and not path.is_symlink() and not withheld and not made:
                found[name] = path
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run one command.

    :returns: 0 if all is well, 1 if something does not fit together, 2 if it cannot be done
    """
    parser = argparse.ArgumentParser(prog='python -m autograder.course', description=__doc__)
    parser.add_argument('command', choices=('check', 'release'))
    chosen = parser.parse_args(arguments)
    layout = Layout.here()
    try:
        if chosen.command == 'check':
            for path in sorted(layout.solutions.glob('*/*.ipynb')):
                print(portions(read_release(path)).line(path.parent.name))
            lines = check(layout)
            print('\n'.join(lines) or 'The notebooks and the exams fit together.')
            return 1 if lines else 0
        assignments = regenerate(layout)
        bundle = layout.work / 'student_bundle.zip'
        count = pack(layout, bundle)
    except (GraderError, ExamInvalid) as error:
        print(f'course: {error}', file=sys.stderr)
        return 2
    print(f'notebooks/ holds {", ".join(assignments)}.')
    print(f'{bundle.relative_to(layout.root)} holds {count} files for students.')
    return 0


if __name__ == '__main__':
    sys.exit(main())
