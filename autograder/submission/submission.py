"""
Rebuild submitted bytes as a notebook that the grader trusts, and find the files of exams.

The grader keeps only the text of answer cells.  Everything else in a submitted notebook (outputs,
tags, metadata, changed tests, extra cells) is dropped, because it could affect nbgrader and
Jupyter.  Invalid input never raises an exception: each mistake becomes a
:class:`~autograder.results.Problem` that lists the answers which are missing because of it.

The magic line of a cell names its file (:mod:`autograder.submission.cells`).  The release defines
the expected file of each cell, so a student who edits a magic line gets a message.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
import copy
from dataclasses import dataclass, replace
from pathlib import Path

from autograder.exam.exam import Exam
from autograder.results import Problem, SubmissionResult
from autograder.submission.cells import CellFile, CellSyntaxError, first_line, parse_cell
from autograder.submission.notebook import (
    answer_cells,
    by_grade_id,
    FRESH_COPY,
    grade_ids,
    marks_of,
    MAX_ANSWER_BYTES,
    Notebook,
    read_cell,
    read_notebook,
    StudentCell,
)
from autograder.submission.package import with_missing_file
from autograder.submission.reading import read_file

MOST_LINES = 20
"""Maximum number of differences in a report."""


@dataclass(frozen=True)
class Opened:
    """
    A submission that can be graded.

    :param problems: the mistakes in the submission; ``cells`` lists the answers that are missing
    :param flags: differences from the release that an instructor should look at, from
        :func:`changes`
    """

    notebook: Notebook
    problems: tuple[Problem, ...]
    flags: tuple[str, ...] = ()

    @property
    def missing(self) -> frozenset[str]:
        """Return the grade ids of the answers that are missing."""
        return frozenset(cell for problem in self.problems for cell in problem.cells)


def open_submission(
    data: bytes | None, release: Notebook, where: str, problems: Sequence[Problem] = ()
) -> Opened:
    """
    Convert submitted bytes to a notebook that can be graded.

    :param data: content of the submitted file, None if no file could be read
    :param problems: problems found earlier, for example in the search for the file
    """
    cells, found = read_notebook(data, where) if data is not None else (None, ())
    notebook, more = rebuild(release, cells, where)
    marks = map(marks_of, release['cells'])
    answers = tuple(one['grade_id'] for one in marks if one.get('solution'))
    if cells is None:
        blamed = [
            replace(problem, cells=answers, unusable=True) for problem in (*problems, *found)
        ]
        return Opened(notebook, tuple(blamed))
    if answers and grade_ids(release).isdisjoint(cell.grade_id for cell in cells):
        got = f'{len(cells)} other cells' if cells else 'a notebook without cells'
        nothing = Problem(where, 'cells of this assignment', got, FRESH_COPY, answers, True)
        return Opened(notebook, (*problems, nothing, *found, *more))
    return Opened(notebook, (*problems, *found, *more), changes(release, cells))


def rebuild(
    release: Notebook, student: Sequence[StudentCell] | None, where: str = 'notebook'
) -> tuple[Notebook, tuple[Problem, ...]]:
    """
    Return the release with the student's answers, which are found by grade id.

    :param student: cells of the submitted notebook; None if it could not be read
    :returns: a new notebook, and the problems found in the student's cells.  For a missing answer,
        the notebook keeps the release's stub, and a problem has the grade id in its ``cells``.
    """
    notebook = copy.deepcopy(release)
    problems: list[Problem] = []
    # The student's first cell for each file that a magic line names.
    by_file = {path: one for one in reversed(student or ()) if (path := _path(one.source))}
    by_id = by_grade_id(student or ())
    for cell in notebook['cells']:
        marks = marks_of(cell)
        if student is not None and marks.get('grade_id'):
            copies = by_id.get(marks['grade_id'], [])
            if marks.get('solution'):
                problems += _fill_in(cell, copies, by_file, where)
            elif copies and copies[0].source.strip() != cell['source'].strip():
                expected = 'the text of the release (this cell is locked)'
                got, fix = 'changed text, which was ignored', 'leave locked cells as they are'
                problems.append(Problem(f'{where}, cell {marks["grade_id"]}', expected, got, fix))
        if cell['cell_type'] == 'code':
            cell['outputs'], cell['execution_count'] = [], None
    return notebook, tuple(problems)


def _fill_in(
    cell: Notebook, copies: Sequence[StudentCell], by_file: Mapping[str, StudentCell], where: str
) -> Iterator[Problem]:
    """Copy the student's first cell with the grade id to an answer cell; yield the problems."""
    grade_id = marks_of(cell)['grade_id']
    spot = f'{where}, cell {grade_id}'
    if not copies:
        got = 'no such cell'
        if other := by_file.get(wanted := _path(cell['source'])):
            title = f'grade id {other.grade_id[:60]!r}' if other.grade_id else 'no grade id'
            got = f'no such cell, only a cell for {wanted} with {title}'
        yield Problem(spot, 'the cell with the answer', got, FRESH_COPY, (grade_id,))
        return
    answer = copies[0]
    if len(answer.source.encode()) > MAX_ANSWER_BYTES:
        limit = f'an answer of at most {MAX_ANSWER_BYTES // 1024} KiB'
        yield Problem(spot, limit, 'a longer answer', 'leave out generated data', (grade_id,))
        return
    if len(copies) > 1:
        got = f'{len(copies)}; the first one counts'
        yield Problem(spot, 'one cell with this grade id', got, 'delete the copies')
    kind = cell['cell_type']
    if answer.cell_type != kind:
        got = f'a {answer.cell_type or "broken"} cell, graded as {kind}'
        fix = f'change the cell type back to {kind} in the notebook toolbar'
        yield Problem(spot, f'a {kind} cell', got, fix)
    cell['source'] = answer.source


def _path(source: str) -> str:
    """Return the file that a cell's magic line names, or an empty string."""
    try:
        found = parse_cell(first_line(source)[0])
    except CellSyntaxError:
        return ''
    return found.path if found else ''


def changes(release: Notebook, cells: Sequence[StudentCell]) -> tuple[str, ...]:
    """
    Return how cells differ from the release, one line per difference for the instructor.

    These differences do not change a grade.  nbgrader's checksums ignore tags, and are wrong for
    every cell whose text is generated at release, so this function compares the cells themselves.
    Data that editors add (outputs, ids, folding, timing) is ignored.
    """
    by_id = by_grade_id(cells)
    lines: list[str] = []
    for released in map(read_cell, release['cells']):
        if released.grade_id:
            lines += _about(released, by_id.pop(released.grade_id, []))
    lines += [
        f'the release has no cell with the grade id {name[:60]!r}'
        for name in sorted(by_id)
        if name
    ]
    more = len(lines) - MOST_LINES
    return (*lines[:MOST_LINES], *([f'{more} more differences from the release'] * (more > 0)))


def _about(released: StudentCell, copies: Sequence[StudentCell]) -> Iterator[str]:
    """Yield how the copies of one cell of the release differ from it."""
    answer = bool(released.marks.get('solution'))
    name = f'{"answer" if answer else "locked"} cell {released.grade_id}'
    if not copies:
        yield f'{name} is missing'
        return
    if len(copies) > 1:
        yield f'{name} occurs {len(copies)} times'
    for cell in copies[:1]:
        if not answer and cell.source.strip() != released.source.strip():
            yield f'{name} has different text'
        if cell.cell_type != released.cell_type:
            yield f'{name} is a {cell.cell_type[:20]!r} cell'
        for key, value in released.marks.items():
            if value is not None and cell.marks.get(key) != value:
                yield f'{name} has a different value of {key}'
        if not answer and sorted(cell.tags) != sorted(released.tags):
            yield f'{name} has the tags {", ".join(cell.tags)[:80] or "removed"!r}'


@dataclass(frozen=True)
class ExamFiles:
    """
    The files that one exam judges, and one problem per answer cell with a different file.

    :param files: relative path to text; a missing answer has no entry
    """

    files: Mapping[str, str]
    problems: tuple[Problem, ...]


def answer_files(release: Notebook) -> dict[str, CellFile]:
    """Return the expected file of each answer cell, by grade id, or raise a CellSyntaxError."""
    return {
        grade_id: found
        for grade_id, cell in answer_cells(release).items()
        if cell['cell_type'] == 'code' and (found := parse_cell(cell['source']))
    }


def extract(
    opened: Opened, exams: Iterable[Exam], release: Notebook, where: str = 'notebook'
) -> dict[str, ExamFiles]:
    """Return the files of every exam by its name, with untouched stubs, which exams report."""
    expected = answer_files(release)
    sources = {marks_of(cell).get('grade_id'): cell['source'] for cell in opened.notebook['cells']}
    result = {}
    for exam in exams:
        files: dict[str, str] = {}
        problems: list[Problem] = []
        for grade_id in exam.cells:
            if grade_id not in opened.missing and (wanted := expected.get(grade_id)):
                problems += _add(sources[grade_id], wanted, files, where, grade_id)
        result[exam.name] = ExamFiles(files, tuple(problems))
    return result


def files_in_notebook(
    path: Path, release: Notebook, exams: Sequence[Exam]
) -> Iterator[tuple[Exam, ExamFiles]]:
    """Yield each exam with its files in a notebook; the problems include the notebook's."""
    data, problems = read_file(path, path.name)
    opened = open_submission(data, release, path.name, problems)
    for exam, found in zip(exams, extract(opened, exams, release, path.name).values()):
        yield exam, replace(found, problems=(*opened.problems, *found.problems))


def with_reasons(result: SubmissionResult, exams: Iterable[Exam]) -> SubmissionResult:
    """Return a result in which each missing file refers to the problem that explains it."""
    cells = {exam.name: set(exam.cells) for exam in exams}
    explained = []
    for exam in result.exams:
        reasons = [one for one in result.problems if cells[exam.exam] & set(one.cells)]
        if reasons:
            fix = f'{reasons[0].try_this[:1].upper()}{reasons[0].try_this[1:]}.'
            why = 'The answer was not found in the submitted file; the note says why.'
            exam = with_missing_file(exam, cause=why, try_this=fix)
        explained.append(exam)
    return replace(result, exams=tuple(explained))


def _add(
    source: str, wanted: CellFile, files: dict[str, str], where: str, grade_id: str
) -> Iterator[Problem]:
    """Add the file of an answer cell; yield a problem if it is not the expected file."""
    try:
        found = parse_cell(source)
    except CellSyntaxError:
        found = None
    if found is not None and found.path == wanted.path:
        files[found.path] = found.body
        return
    line, first = f'%%{wanted.kind} {wanted.name}', first_line(source)[0].strip()
    got = repr(first[:60]) if first else 'an empty cell'
    fix = f'write {line} as the first line again'
    yield Problem(f'{where}, cell {grade_id}', f'the first line {line}', got, fix, (grade_id,))
