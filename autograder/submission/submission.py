"""
Convert submitted bytes to a notebook that the grader trusts: the release plus the answers.

The grader keeps only the text of answer cells.  Everything else in a submitted notebook (outputs,
tags, metadata, changed tests, extra cells) is dropped, because it could affect nbgrader and
Jupyter.  Invalid input never raises an exception: each mistake becomes a
:class:`~autograder.results.Problem` that lists the answers which are missing because of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
import copy
from dataclasses import dataclass, replace

from autograder.results import Problem
from autograder.submission.cells import CellSyntaxError, first_line, parse_cell
from autograder.submission.integrity import changes
from autograder.submission.notebook import (
    by_grade_id,
    FRESH_COPY,
    grade_ids,
    marks_of,
    MAX_ANSWER_BYTES,
    Notebook,
    read_notebook,
    StudentCell,
)


@dataclass(frozen=True)
class Opened:
    """
    A submission that can be graded.

    :param notebook: the release with the student's answers
    :param problems: the mistakes in the submission; ``cells`` of each lists the missing answers
    :param flags: differences from the release that an instructor should look at, see
        :mod:`autograder.submission.integrity`
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
    :param release: the notebook that students received
    :param where: name of the submitted file in messages
    :param problems: problems that were found before, for example in the search for the file
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

    :param release: the notebook that students received
    :param student: cells of the submitted notebook; None if it could not be read
    :param where: name of the submitted file in messages
    :returns: a new notebook, and the problems of the answers.  For a missing answer, the notebook
        keeps the release's stub, and the ``cells`` of a problem contain the grade id.
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
                problems.append(_changed_check(marks['grade_id'], where))
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
        yield _missing_answer(cell, by_file, spot)
        return
    answer = copies[0]
    if len(answer.source.encode()) > MAX_ANSWER_BYTES:
        limit = f'an answer of at most {MAX_ANSWER_BYTES // 1024} KiB'
        yield Problem(spot, limit, 'a longer one', 'leave out generated data', (grade_id,))
        return
    if len(copies) > 1:
        yield Problem(
            spot,
            'one cell with this grade id',
            f'{len(copies)}; the first one counts',
            'delete the copies',
        )
    if answer.cell_type != cell['cell_type']:
        yield Problem(
            spot,
            f'a {cell["cell_type"]} cell',
            f'a {answer.cell_type or "broken"} cell, graded as {cell["cell_type"]}',
            f'change the cell type back to {cell["cell_type"]} in the notebook toolbar',
        )
    cell['source'] = answer.source


def _missing_answer(cell: Notebook, by_file: Mapping[str, StudentCell], spot: str) -> Problem:
    """Return the problem of a missing answer; it names any other cell for the same file."""
    grade_id, wanted = marks_of(cell)['grade_id'], _path(cell['source'])
    got = 'no such cell'
    if wanted in by_file:
        name = by_file[wanted].grade_id
        title = f'grade id {name[:60]!r}' if name else 'no grade id'
        got = f'no such cell, only a cell for {wanted} with {title}'
    return Problem(spot, 'the cell with the answer', got, FRESH_COPY, (grade_id,))


def _path(source: str) -> str:
    """Return the file that a cell's magic line names, or an empty string."""
    try:
        found = parse_cell(first_line(source)[0])
    except CellSyntaxError:
        return ''
    return found.path if found else ''


def _changed_check(grade_id: str, where: str) -> Problem:
    """Return the problem of an edited locked cell, whose changes are ignored."""
    return Problem(
        f'{where}, cell {grade_id}',
        'the text of the release (this cell is locked)',
        'changed text, which was ignored',
        'leave locked cells as they are',
    )
