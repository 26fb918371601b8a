"""
From the bytes a student handed in to a notebook we trust: the release plus the answers.

Only the text of answer cells survives.  Everything else in a submitted notebook - outputs,
tags, metadata, changed tests, extra cells - is dropped, because nbgrader and Jupyter act on
it.  Nothing here raises on bad input: what is wrong becomes a
:class:`~autograder.judging.results.Problem` that says which answers are missing because of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
import copy
from dataclasses import dataclass, field, replace
import json
from pathlib import Path
from typing import Any

from autograder.handed_in.cells import CellSyntaxError, first_line, parse_cell
from autograder.handed_in.integrity import changes, MARKS, small_number
from autograder.judging.results import Problem

Notebook = dict[str, Any]
"""A notebook in format 4, as JSON types."""

MAX_BYTES = 16 * 1024 * 1024
MAX_PARTS = 500_000
"""Bound on lists, objects and strings: a small file of ``[],[],...`` fills the memory."""
MAX_CELLS = 5_000
MAX_ANSWER_BYTES = 64 * 1024
"""Bound on one answer, ten times a long one: it goes to a compiler and a database."""

FRESH_COPY = 'download a fresh copy of the assignment and copy the answers into it'


@dataclass(frozen=True)
class StudentCell:
    """One cell of a submitted notebook: all we read of it."""

    grade_id: str
    cell_type: str
    source: str
    marks: Mapping[str, Any] = field(default_factory=dict)
    tags: tuple[str, ...] = ()


@dataclass(frozen=True)
class Opened:
    """
    A submission that can be graded.

    :param notebook: the release with the student's answers in it
    :param problems: what was wrong; ``cells`` of each names the answers that are missing
    :param flags: what an instructor should look at, see :mod:`autograder.handed_in.integrity`
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
    Turn submitted bytes into a notebook that can be graded.

    :param data: content of the submitted file, None if there is none to read
    :param release: the notebook that students received
    :param where: how to name the file in messages
    :param problems: what went wrong before, for example when the file was looked for
    """
    cells, found = read_notebook(data, where) if data is not None else (None, ())
    notebook, more = rebuild(release, cells, where)
    if cells is None:
        answers = tuple(answer_ids(release))
        blamed = [replace(problem, cells=answers) for problem in (*problems, *found)]
        return Opened(notebook, tuple(blamed))
    return Opened(notebook, (*problems, *found, *more), changes(release, cells))


def read_notebook(
    data: bytes, where: str
) -> tuple[tuple[StudentCell, ...] | None, tuple[Problem, ...]]:
    """
    Read the cells of a submitted notebook.

    :param data: content of the file
    :param where: how to name the file in messages
    :returns: the cells, or None if this is no notebook; and what is wrong
    """

    def refuse(expected: str, got: str, try_this: str) -> tuple[None, tuple[Problem, ...]]:
        return None, (Problem(where, expected, got, try_this),)

    if len(data) > MAX_BYTES:
        return None, (too_large(where, len(data)),)
    if not data or data.isspace():
        return refuse('a Jupyter notebook', 'an empty file', 'save the notebook and submit again')
    if _parts(data) > MAX_PARTS:
        return refuse('a Jupyter notebook', 'far too many parts', FRESH_COPY)
    objects = _Objects()
    try:
        # Only points are compared; int() takes hours for a number of a few megabytes.
        content = json.loads(
            data.decode('utf-8-sig'),
            parse_int=small_number,
            parse_float=small_number,
            object_pairs_hook=objects,
        )
    except UnicodeDecodeError as error:
        got = f'bytes that are not UTF-8 (byte {error.start})'
        return refuse('a Jupyter notebook in UTF-8', got, 'save it in JupyterLab and submit again')
    except RecursionError:
        return refuse('a Jupyter notebook', 'JSON nested too deeply', FRESH_COPY)
    except ValueError as error:
        return refuse('a Jupyter notebook', _broken_json(data, error), _json_advice(data))
    cells, problems = _read_cells(content, where)
    if objects.repeated and cells is not None:
        got = f'{objects.repeated[:40]!r} more than once in one object; the last one counts'
        problems = (Problem(where, 'every JSON key once', got, FRESH_COPY),)
    return cells, problems


class _Objects:
    """Makes JSON objects and notices a key that is there twice: readers differ in which counts."""

    repeated = ''

    def __call__(self, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        """Make one object."""
        made = dict(pairs)
        if len(made) != len(pairs) and not self.repeated:
            seen: set[str] = set()
            for name, _ in pairs:
                if name in seen:
                    self.repeated = name
                    break
                seen.add(name)
        return made


def too_large(where: str, size: int) -> Problem:
    """Say that a file is larger than any notebook we read."""
    limit = f'a file of at most {MAX_BYTES // 2**20} MiB'
    got = f'{size / 2**20:.1f} MiB'
    return Problem(where, limit, got, 'clear all outputs, save and submit again')


def _parts(data: bytes) -> int:
    """Count at least what the parser makes of the text: each string begins with a bare quote."""
    quotes = data.count(b'"') - data.count(b'\\"')
    return data.count(b'[') + data.count(b'{') + quotes


def _broken_json(data: bytes, error: ValueError) -> str:
    """Say whether the text is cut off, no JSON at all, or broken at a line."""
    if not data.lstrip(b'\xef\xbb\xbf \t\r\n').startswith(b'{'):
        return 'a file that is not JSON'
    if not data.rstrip().endswith(b'}'):
        return f'JSON that ends in the middle, after {len(data)} bytes'
    line = getattr(error, 'lineno', 0)
    return f'broken JSON in line {line}' if line else 'broken JSON'


def _json_advice(data: bytes) -> str:
    """Tell what to do about text that is not JSON."""
    if not data.lstrip(b'\xef\xbb\xbf \t\r\n').startswith(b'{'):
        return 'submit the .ipynb file itself, not an export, a picture or an archive of it'
    return 'open the notebook in JupyterLab, save it and submit the saved file'


def _read_cells(
    content: object, where: str
) -> tuple[tuple[StudentCell, ...] | None, tuple[Problem, ...]]:
    """Read what we use of parsed JSON, ignoring anything odd beside it."""
    cells = content.get('cells') if isinstance(content, dict) else None
    if not isinstance(cells, list):
        old = isinstance(content, dict) and 'worksheets' in content
        got = 'a notebook in format 3' if old else 'JSON that has no list of cells'
        try_this = 'open it in JupyterLab, which converts it, and save' if old else FRESH_COPY
        return None, (Problem(where, 'a Jupyter notebook in format 4', got, try_this),)
    if len(cells) > MAX_CELLS:
        expected = f'at most {MAX_CELLS} cells'
        return None, (Problem(where, expected, f'{len(cells)} cells', FRESH_COPY),)
    return tuple(_read_cell(cell) for cell in cells), ()


def _read_cell(cell: object) -> StudentCell:
    """Read one cell; parts of the wrong type count as empty."""
    if not isinstance(cell, dict):
        return StudentCell('', '', '')
    metadata = cell.get('metadata')
    metadata = metadata if isinstance(metadata, dict) else {}
    marks = metadata.get('nbgrader')
    marks = marks if isinstance(marks, dict) else {}
    grade_id, tags = marks.get('grade_id'), metadata.get('tags')
    kind, source = cell.get('cell_type'), cell.get('source')
    if isinstance(source, list):
        source = ''.join(part for part in source if isinstance(part, str))
    return StudentCell(
        grade_id if isinstance(grade_id, str) else '',
        kind if isinstance(kind, str) else '',
        _clean(source) if isinstance(source, str) else '',
        {name: marks[name] for name in MARKS if name in marks},
        tuple(tag for tag in tags if isinstance(tag, str)) if isinstance(tags, list) else (),
    )


def _clean(text: str) -> str:
    """
    Return text with Unix line ends and no half surrogate pairs, which no file can hold.

    Of a text that is too long for an answer, only so much is kept that it stays too long.
    """
    text = text[: 2 * (MAX_ANSWER_BYTES + 1)]  # two characters of it are one Windows line end
    text = text.replace('\r\n', '\n').replace('\r', '\n')
    return text.encode('utf-8', 'replace').decode('utf-8')


def marks_of(cell: Notebook) -> dict[str, Any]:
    """Return a trusted cell's nbgrader metadata, empty if it has none."""
    marks = cell.get('metadata', {}).get('nbgrader', {})
    return marks if isinstance(marks, dict) else {}


def read_release(path: Path) -> Notebook:
    """
    Read a notebook of ours: the text of each cell becomes one string, as nbformat has it.

    :raises OSError: if it cannot be read
    :raises ValueError: if it is no notebook
    """
    notebook = json.loads(path.read_text(encoding='utf-8'))
    if not isinstance(notebook, dict) or not isinstance(notebook.get('cells'), list):
        raise ValueError(f'{path.name} is no notebook in format 4')
    for cell in notebook['cells']:
        cell['source'] = ''.join(cell['source'])
    return notebook


def answer_ids(release: Notebook) -> Iterator[str]:
    """Yield the grade ids of all cells that students fill in."""
    for cell in release['cells']:
        marks = marks_of(cell)
        if marks.get('solution'):
            yield marks['grade_id']


def rebuild(
    release: Notebook, student: Sequence[StudentCell] | None, where: str = 'notebook'
) -> tuple[Notebook, tuple[Problem, ...]]:
    """
    Return the release with the student's answers in it, found by grade id.

    :param release: the notebook that students received
    :param student: cells of the submitted notebook; None if it could not be read
    :param where: how to name the file in messages
    :returns: a new notebook and what is to be said about the answers.  A missing answer leaves
        the release's stub in place and is named by a problem's ``cells``.
    """
    notebook = copy.deepcopy(release)
    problems: list[Problem] = []
    by_file = _by_file(student or ())
    by_id: dict[str, list[StudentCell]] = {}
    for found in student or ():
        by_id.setdefault(found.grade_id, []).append(found)
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
    """Put the first of the student's copies into an answer cell; yield what is wrong."""
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
            'set the cell type back in the notebook toolbar',
        )
    cell['source'] = answer.source


def _missing_answer(cell: Notebook, by_file: Mapping[str, StudentCell], spot: str) -> Problem:
    """Say that an answer is missing, and where a cell looks like it."""
    grade_id, wanted = marks_of(cell)['grade_id'], _path(cell['source'])
    got = 'no such cell'
    if wanted in by_file:
        name = by_file[wanted].grade_id
        title = f'grade id {name[:60]!r}' if name else 'no grade id'
        got = f'no such cell, only a cell for {wanted} with {title}'
    return Problem(spot, 'the cell with the answer', got, FRESH_COPY, (grade_id,))


def _by_file(cells: Sequence[StudentCell]) -> dict[str, StudentCell]:
    """Return the first cell for each file that a magic line names."""
    found: dict[str, StudentCell] = {}
    for cell in cells:
        path = _path(cell.source)
        if path:
            found.setdefault(path, cell)
    return found


def _path(source: str) -> str:
    """Return which file a cell's magic line names, empty if none."""
    try:
        found = parse_cell(first_line(source)[0])
    except CellSyntaxError:
        return ''
    return found.path if found else ''


def _changed_check(grade_id: str, where: str) -> Problem:
    """Say that a locked cell was edited; the release's text is used."""
    return Problem(
        f'{where}, cell {grade_id}',
        'the text of the release (this cell is locked)',
        'a changed text, which was ignored',
        'leave locked cells as they are',
    )
