"""
Check and release the course: ``python -m autograder.authoring.release check | release``.

``check`` verifies that the committed files agree; ``release`` generates ``notebooks/``, checks the
course, and packs the students' copy.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path
import re
import sys
import tempfile
from typing import TYPE_CHECKING

from autograder.authoring.portions import portions
from autograder.authoring.student_bundle import NO_PARTS, pack
from autograder.errors import GraderError
from autograder.gradebook.record import unfit_points
from autograder.layout import Layout, lesson_files
from autograder.submission.extract import CHECK_PREFIX
from autograder.submission.notebook import marks_of, Notebook, read_release

if TYPE_CHECKING:
    from autograder.exam.exam import Exam

CHECK_CELL = re.compile(r"^check\((['\"])(?P<exam>\w+)\1\)$")


# -- check ----------------------------------------------------------------------------------


def check(layout: Layout, exams: Sequence[Exam] | None = None) -> list[str]:
    """
    Return the mistakes of the course, one line each; empty if there are none.

    :param exams: exams to use instead of the course's own, for tests
    """
    from autograder.authoring.lesson_frame import outlines, unknown_needs

    found = [*drift(layout), *unknown_needs(outlines(layout.solutions))]
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


def unfit_exams(layout: Layout) -> list[str]:
    """Return mistakes in the exams, such as unknown types or differences between versions."""
    from autograder.authoring.exam_mistakes import mistakes_of
    from autograder.exam.catalog import for_assignment

    exams = [exam for one in layout.assignments() for exam in for_assignment(one)]
    return mistakes_of(exams, layout.notebooks)


def notebook_files(layout: Layout) -> Iterator[Path]:
    """Yield the paths of all notebooks in ``solutions/`` and ``notebooks/``."""
    for folder in (layout.solutions, layout.notebooks):
        yield from lesson_files(folder)


def drift(layout: Layout) -> Iterator[str]:
    """Yield one line for each file in ``notebooks/`` that a new release would change."""
    with tempfile.TemporaryDirectory(prefix='release_') as folder:
        _generate(layout, Path(folder))
        wanted = _contents(Path(folder))
    there = _contents(layout.notebooks)
    for name in sorted(wanted.keys() | there.keys()):
        if wanted.get(name) != there.get(name):
            got = 'another text' if name in wanted and name in there else 'none'
            expected = 'what solutions/ gives' if name in wanted else 'no such file'
            got = got if name in wanted else 'a file'
            yield f'notebooks/{name}: expected {expected}, got {got}. Try: make release.'


def _contents(folder: Path) -> dict[str, bytes]:
    """Return the content of all files in a folder by path, except files that learners create."""
    if not folder.is_dir():
        return {}
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob('*')
        if path.is_file() and not NO_PARTS & set(path.relative_to(folder).parts)
    }


def stored_outputs(notebook: Notebook, where: str) -> Iterator[str]:
    """Yield one line for each cell with a stored output or execution count."""
    for number, cell in enumerate(notebook['cells'], 1):
        if cell.get('outputs') or cell.get('execution_count') is not None:
            yield f'{where}, cell {number}: expected no stored output. Try: clear all outputs.'


def repeated_ids(notebook: Notebook, where: str, seen: dict[str, str]) -> Iterator[str]:
    """
    Yield one line for each grade id that another cell already uses.

    :param seen: notebook by grade id; the ids of this notebook are added
    """
    for cell in notebook['cells']:
        grade_id = marks_of(cell).get('grade_id')
        if grade_id in seen:
            yield f'{where}, cell {grade_id}: this grade id is also used in {seen[grade_id]}.'
        elif grade_id:
            seen[grade_id] = where


def unfit_checks(
    notebook: Notebook, where: str, assignment: str, exams: Sequence[Exam] | None
) -> Iterator[str]:
    """Yield one line for each check cell that does not match the exams of its lesson."""
    if exams is None:
        from autograder.exam.catalog import for_assignment

        exams = for_assignment(assignment)
    known = {exam.name: exam for exam in exams}
    answers: set[str] = set()
    for cell in notebook['cells']:
        marks = marks_of(cell)
        if marks.get('solution'):
            answers.add(marks['grade_id'])
        elif marks.get('grade') and cell['cell_type'] == 'code':
            yield from _unfit_check(cell, f'{where}, cell {marks["grade_id"]}', known, answers)
    yield from unfit_points(notebook, where, exams)


def _unfit_check(
    cell: Notebook, where: str, known: dict[str, Exam], answers: set[str]
) -> Iterator[str]:
    """Yield mistakes in the code of a check cell or in its position below the answers."""
    marks = marks_of(cell)
    match = CHECK_CELL.match(cell['source'].strip())
    name = match['exam'] if match else ''
    if marks['grade_id'] != f'{CHECK_PREFIX}{name}':
        expected = f"check('{marks['grade_id'].removeprefix(CHECK_PREFIX)}')"
        yield f'{where}: expected the one line {expected}, got {cell["source"][:60]!r}.'
        return
    needed = known[name].cells if name in known else ()
    for grade_id in sorted(set(needed) - answers):
        yield f'{where}: the exam needs the answer {grade_id}, but no cell above has that id.'


# -- release --------------------------------------------------------------------------------


def regenerate(layout: Layout) -> tuple[str, ...]:
    """
    Generate ``notebooks/`` from ``solutions/``.

    :returns: the assignments
    :raises GraderError: if there is no assignment, or with nbgrader's message if nbgrader fails
    """
    if not (assignments := _generate(layout, layout.notebooks)):
        raise GraderError(f'{layout.solutions}: expected ASSIGNMENT/NOTEBOOK.ipynb, got none.')
    return assignments


def _generate(layout: Layout, folder: Path) -> tuple[str, ...]:
    """Generate the students' notebooks into a folder, and return the assignments."""
    from autograder.authoring.lesson_frame import start_here
    from autograder.gradebook import converters

    assignments = sorted({path.parent.name for path in lesson_files(layout.solutions)})
    for assignment in assignments:
        converters.generate(layout, assignment, folder, database=False)
    start_here(layout.solutions, folder)
    return tuple(assignments)


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run one command.

    :returns: exit code: 0 without mistakes, 1 if there are mistakes, 2 if the command failed
    """
    parser = argparse.ArgumentParser(
        prog='python -m autograder.authoring.release', description=__doc__
    )
    parser.add_argument('command', choices=('check', 'release'))
    parser.add_argument(
        '--answers',
        action='store_true',
        help='let students see a worked answer after full points or three tries',
    )
    chosen = parser.parse_args(arguments)
    layout = Layout.here()
    try:
        if chosen.command == 'check':
            for path in lesson_files(layout.solutions):
                print(portions(read_release(path)).line(path.parent.name))
            lines = check(layout)
            print('\n'.join(lines) or 'The notebooks and the exams fit together.')
            return 1 if lines else 0
        assignments = regenerate(layout)
        if lines := check(layout):
            print('\n'.join(lines))
            said = 'course: nothing was packed. Try: fix this, then make release'
            print(said, file=sys.stderr)
            return 1
        bundle = layout.work / 'student_bundle.zip'
        count = pack(layout, bundle, chosen.answers)
    except GraderError as error:
        print(f'course: {error}', file=sys.stderr)
        return 2
    print(f'notebooks/ holds {", ".join(assignments)}.')
    print(f'{bundle.relative_to(layout.root)} holds {count} files for students.')
    return 0


if __name__ == '__main__':
    sys.exit(main())
