"""
Check and release the course: ``python -m autograder.authoring.release check | release``.

``check`` verifies that the committed files are consistent; ``release`` generates ``notebooks/``,
checks the course, and packs the students' copy.
"""

import argparse
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
import re
from statistics import median
import sys
import tempfile

from autograder.authoring.exam_mistakes import mistakes_of
from autograder.authoring.lesson_frame import outlines, start_here, unknown_needs
from autograder.authoring.student_bundle import NO_PARTS, pack
from autograder.errors import GraderError
from autograder.exam.catalog import for_assignment
from autograder.exam.exam import Exam
from autograder.gradebook import converters
from autograder.gradebook.record import points_mismatches
from autograder.layout import Layout, lesson_files
from autograder.submission.cells import CellSyntaxError, parse_cell
from autograder.submission.notebook import CHECK_PREFIX, is_check, marks_of, Notebook, read_release

WORDS = (25, 60)
"""Minimum and maximum of the median number of words per text cell."""
LINES = (1, 5)
"""Minimum and maximum of the median number of lines per code cell, files excluded."""
MOST_LINES = 12
MOST_LINES_IN_A_FILE = 100

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
            found += [f'{where}: {line}' for line in portions(notebook).problems()]
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
            yield f'notebooks/{name}: expected {expected}, got {got}. Try: make release.'


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


# -- lengths of cells -----------------------------------------------------------------------


@dataclass(frozen=True)
class Portions:
    """
    The lengths of the cells of one lesson.

    Well-known notebooks that learners like have 30 to 50 words per text cell and 1 to 5 lines per
    code cell; notebooks that learners abandon have long texts and code cells of 90 lines.

    :param words: number of words of each text cell
    :param lines: number of lines of each code cell that is not a file
    :param file_lines: number of lines of each code cell that is a file of a package
    """

    words: tuple[int, ...]
    lines: tuple[int, ...]
    file_lines: tuple[int, ...]

    def line(self, lesson: str) -> str:
        """Return the figures of the lesson as one line of text."""
        return (
            f'{lesson:28} {len(self.words):3} text cells, median {median(self.words):4g} words;  '
            f'{len(self.lines):3} code cells, median {median(self.lines):3g} lines, '
            f'maximum {max(self.lines)}'
        )

    def problems(self) -> Iterator[str]:
        """Yield one sentence for each figure outside its range."""
        for what, values, (least, most) in (
            ('words per text cell', self.words, WORDS),
            ('lines per code cell', self.lines, LINES),
        ):
            if not least <= median(values) <= most:
                yield f'expected a median of {least} to {most} {what}, got {median(values):g}.'
        for what, values, limit in (
            ('code cell', self.lines, MOST_LINES),
            ('file', self.file_lines, MOST_LINES_IN_A_FILE),
        ):
            if values and max(values) > limit:
                yield f'expected no {what} longer than {limit} lines, got one of {max(values)}.'


def portions(notebook: Notebook) -> Portions:
    """Measure the cells of a lesson."""
    words: list[int] = []
    lines: list[int] = []
    file_lines: list[int] = []
    for cell in notebook['cells']:
        if cell['cell_type'] == 'markdown':
            # Code blocks and HTML tags are not read as words.
            shown = re.sub(r'```.*?```|<[^<>]+>', ' ', cell['source'], flags=re.DOTALL)
            words.append(len(re.findall(r"\w[\w'.-]*", shown)))
        elif cell['cell_type'] == 'code':
            file = None
            with suppress(CellSyntaxError):
                file = parse_cell(cell['source'])
            count = sum(1 for line in cell['source'].splitlines() if line.strip())
            (file_lines if file else lines).append(count)
    return Portions(tuple(words), tuple(lines), tuple(file_lines))


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
            print('\n'.join(lines) or 'The notebooks and the exams agree.')
            return 1 if lines else 0
        if not (assignments := generate(layout, layout.notebooks)):
            raise GraderError(f'{layout.solutions}: expected ASSIGNMENT/NOTEBOOK.ipynb, got none.')
        if lines := check(layout):
            print('\n'.join(lines))
            said = 'course: not packed. Try: fix these mistakes, then make release'
            print(said, file=sys.stderr)
            return 1
        bundle = layout.work / 'student_bundle.zip'
        count = pack(layout, bundle, chosen.answers)
    except GraderError as error:
        print(f'course: {error}', file=sys.stderr)
        return 2
    print(f'notebooks/ contains {", ".join(assignments)}.')
    print(f'{bundle.relative_to(layout.root)} contains {count} files for students.')
    return 0


if __name__ == '__main__':
    sys.exit(main())
