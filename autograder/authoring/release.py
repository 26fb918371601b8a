"""Check that the files of a course agree, and generate ``notebooks/`` from ``solutions/``."""

from collections.abc import Iterator, Sequence
from pathlib import Path
import tempfile

from autograder.authoring.exam_mistakes import mistakes_of
from autograder.authoring.lesson_frame import outlines, start_here, unknown_needs
from autograder.authoring.student_bundle import NO_PARTS
from autograder.exam.catalog import for_assignment
from autograder.exam.exam import Exam
from autograder.gradebook import converters
from autograder.gradebook.record import points_mismatches
from autograder.layout import Layout, lesson_files
from autograder.submission.notebook import CHECK_PREFIX, is_check, marks_of, Notebook, read_release

# -- check ----------------------------------------------------------------------------------


def check(layout: Layout) -> list[str]:
    """Return the mistakes of the course, one line each; empty if there are none."""
    found = [*drift(layout), *unknown_needs(outlines(layout.solutions))]
    seen: dict[str, str] = {}
    for path in (*lesson_files(layout.solutions), *lesson_files(layout.notebooks)):
        where = path.relative_to(layout.root).as_posix()
        notebook = read_release(path)
        found += stored_outputs(notebook, where)
        if path.is_relative_to(layout.solutions):
            found += repeated_ids(notebook, where, seen)
            found += unfit_checks(notebook, where, for_assignment(path.parent.name))
    exams = [exam for one in layout.assignments() for exam in for_assignment(one)]
    return [*found, *mistakes_of(exams, layout.notebooks)]


def drift(layout: Layout) -> Iterator[str]:
    """Yield one line for each file in ``notebooks/`` that a new release would change."""
    with tempfile.TemporaryDirectory(prefix='release_') as folder:
        generate(layout, Path(folder))
        wanted = _contents(Path(folder))
    there = _contents(layout.notebooks)
    for name in sorted(wanted.keys() | there.keys()):
        if wanted.get(name) != there.get(name):
            got = 'different content' if name in wanted and name in there else 'none'
            expected = 'the release of solutions/' if name in wanted else 'no such file'
            got = got if name in wanted else 'a file'
            fix = '.venv/bin/autograder release' if name in wanted else 'remove it'
            yield f'notebooks/{name}: expected {expected}, got {got}. Try: {fix}.'


def _contents(folder: Path) -> dict[str, bytes]:
    """Return the content of all files in a folder by path, except files that learners create."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob('*')
        if path.is_file() and NO_PARTS.isdisjoint(path.relative_to(folder).parts)
    }


def stored_outputs(notebook: Notebook, where: str) -> Iterator[str]:
    """Yield one line for each cell with a stored output or execution count."""
    for number, cell in enumerate(notebook['cells'], 1):
        if cell.get('outputs') or cell.get('execution_count') is not None:
            yield f'{where}, cell {number}: expected no stored output. Try: clear all outputs.'


def repeated_ids(notebook: Notebook, where: str, seen: dict[str, str]) -> Iterator[str]:
    """Yield one line for each grade id already in ``seen``; add all others with their notebook."""
    for cell in notebook['cells']:
        grade_id = marks_of(cell).get('grade_id')
        if grade_id in seen:
            yield f'{where}, cell {grade_id}: this grade id is also used in {seen[grade_id]}.'
        elif grade_id:
            seen[grade_id] = where


def unfit_checks(notebook: Notebook, where: str, exams: Sequence[Exam]) -> Iterator[str]:
    """Yield one line for each check cell that does not match the exams of its lesson."""
    needs = {exam.name: set(exam.cells) for exam in exams}
    answers: set[str] = set()
    for cell in notebook['cells']:
        marks = marks_of(cell)
        if marks.get('solution'):
            answers.add(marks['grade_id'])
        elif is_check(cell):
            grade_id, source = marks['grade_id'], cell['source'].strip()
            name = grade_id.removeprefix(CHECK_PREFIX)
            expected = f"check('{name}')"
            if source.replace('"', "'") != expected or name == grade_id:
                got = repr(source[:60])
                yield f'{where}, cell {grade_id}: expected the one line {expected}, got {got}.'
                continue
            for needed in sorted(needs.get(name, set()) - answers):
                yield (
                    f'{where}, cell {grade_id}: the exam needs the answer {needed}, but no cell '
                    'above has that id.'
                )
    yield from points_mismatches(notebook, where, exams)


# -- release --------------------------------------------------------------------------------


def generate(layout: Layout, folder: Path) -> list[str]:
    """
    Generate the students' notebooks from ``solutions/`` into a folder; return the assignments.

    :raises GraderError: with nbgrader's message if nbgrader fails
    """
    assignments = sorted({path.parent.name for path in lesson_files(layout.solutions)})
    for assignment in assignments:
        converters.generate(layout, assignment, folder, database=False)
    start_here(layout.solutions, folder)
    return assignments
