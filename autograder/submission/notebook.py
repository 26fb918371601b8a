"""Read notebooks: trusted ones from the course, and untrusted ones from students."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
import json
from pathlib import Path
from typing import Any

from autograder.results import Problem

Notebook = dict[str, Any]
"""A notebook in format 4, as JSON types."""
MAX_BYTES = 16 * 1024 * 1024
MAX_PARTS = 500_000
"""Limit of lists, objects and strings: a small file of ``[],[],...`` could fill the memory."""
MAX_CELLS = 5_000
MAX_ANSWER_BYTES = 64 * 1024
"""Maximum answer size [bytes], ten times a long answer; compilers and databases must handle it."""
CHECK_PREFIX = 'check_'
"""Prefix of the grade id of a check cell; the name of the exam follows."""
FRESH_COPY = 'download a fresh copy of the assignment and copy the answers into it'


@dataclass(frozen=True)
class StudentCell:
    """The parts that the grader reads of a submitted or released cell, with its :data:`MARKS`."""

    grade_id: str
    cell_type: str
    source: str
    marks: Mapping[str, Any] = field(default_factory=dict)
    tags: tuple[str, ...] = ()


def read_notebook(
    data: bytes, where: str
) -> tuple[tuple[StudentCell, ...] | None, tuple[Problem, ...]]:
    """Return the cells of a submitted notebook, None if it is not one, and the problems."""
    if len(data) > MAX_BYTES:
        return None, (too_large(where, len(data)),)
    repeated: list[str] = []
    try:
        cells = _cells_of(_content_of(data, repeated))
    except _RefusedError as error:
        return None, (Problem(where, *error.args),)
    if not repeated:
        return cells, ()
    got = f'{repeated[0][:40]!r} more than once in one object; the last one counts'
    return cells, (Problem(where, 'every JSON key once', got, FRESH_COPY),)


class _RefusedError(ValueError):
    """Report that a file is not a notebook: what was expected, what it is, and what to try."""


def too_large(where: str, size: int) -> Problem:
    """Return the problem of a file that exceeds the limit for notebooks."""
    limit = f'a file of at most {MAX_BYTES // 2**20} MiB'
    got = f'{size / 2**20:.1f} MiB'
    return Problem(where, limit, got, 'clear all outputs, save and submit again')


def _content_of(data: bytes, repeated: list[str]) -> object:
    """Parse JSON; add a repeated key, whose value would depend on the parser, to a list."""

    def make(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        made = dict(pairs)
        if len(made) != len(pairs) and not repeated:
            repeated.append(Counter(name for name, _ in pairs).most_common(1)[0][0])
        return made

    notebook = 'a Jupyter notebook'
    if not data or data.isspace():
        raise _RefusedError(notebook, 'an empty file', 'save the notebook and submit again')
    # Estimate the number of lists, objects and strings without parsing them.
    quotes = data.count(b'"') - data.count(b'\\"')
    if data.count(b'[') + data.count(b'{') + quotes > MAX_PARTS:
        raise _RefusedError(notebook, 'far too many JSON values', FRESH_COPY)
    try:
        # The grader needs only small numbers, and int() takes hours for millions of digits.
        return json.loads(
            data.decode('utf-8-sig'),
            parse_int=small_number,
            parse_float=small_number,
            object_pairs_hook=make,
        )
    except UnicodeDecodeError as error:
        got = f'bytes that are not UTF-8 (byte {error.start})'
        fix = 'save it in JupyterLab and submit again'
        raise _RefusedError(f'{notebook} in UTF-8', got, fix) from None
    except RecursionError:
        raise _RefusedError(notebook, 'JSON nested too deeply', FRESH_COPY) from None
    except ValueError as error:
        raise _RefusedError(notebook, *_broken_json(data, error)) from None


def _broken_json(data: bytes, error: ValueError) -> tuple[str, str]:
    """Return how JSON is broken (not JSON, truncated, or invalid in a line) and what to try."""
    if not data.lstrip(b'\xef\xbb\xbf \t\r\n').startswith(b'{'):
        fix = 'submit the .ipynb file itself, not an export, a picture or an archive of it'
        return 'a file that is not JSON', fix
    fix = 'open the notebook in JupyterLab, save it and submit the saved file'
    text, place = getattr(error, 'doc', '').rstrip(), getattr(error, 'pos', 0)
    if not text.endswith('}') or place >= len(text):
        return f'JSON that ends in the middle, after {len(data)} bytes', fix
    line = getattr(error, 'lineno', 0)
    return f'broken JSON in line {line}' if line else 'broken JSON', fix


def _cells_of(content: object) -> tuple[StudentCell, ...]:
    """Return the cells of a parsed notebook; unexpected data is ignored."""
    cells = content.get('cells') if isinstance(content, dict) else None
    if not isinstance(cells, list):
        old = isinstance(content, dict) and 'worksheets' in content
        got = 'a notebook in format 3' if old else 'JSON that has no list of cells'
        fix = 'open it in JupyterLab, which converts it, and save' if old else FRESH_COPY
        raise _RefusedError('a Jupyter notebook in format 4', got, fix)
    if len(cells) > MAX_CELLS:
        raise _RefusedError(f'at most {MAX_CELLS} cells', f'{len(cells)} cells', FRESH_COPY)
    return tuple(map(read_cell, cells))


def read_cell(cell: object) -> StudentCell:
    """Read one cell; treat parts of the wrong type as empty."""
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
    Return text with Unix line endings and no lone surrogates, which UTF-8 cannot encode.

    Text that is too long for an answer is truncated, but remains longer than the limit.
    """
    # Keep twice the limit, because a Windows line ending has two characters.
    text = text[: 2 * (MAX_ANSWER_BYTES + 1)]
    text = text.replace('\r\n', '\n').replace('\r', '\n')
    return text.encode('utf-8', 'replace').decode('utf-8')


def marks_of(cell: Notebook) -> dict[str, Any]:
    """Return a trusted cell's nbgrader metadata; empty if it has none."""
    marks = cell.get('metadata', {}).get('nbgrader', {})
    return marks if isinstance(marks, dict) else {}


def answer_cells(notebook: Notebook) -> dict[str, Notebook]:
    """Return the answer cells of a trusted notebook, by grade id."""
    marked = ((marks_of(cell), cell) for cell in notebook['cells'])
    return {marks['grade_id']: cell for marks, cell in marked if marks.get('solution')}


def is_check(cell: Notebook) -> bool:
    """Return whether an exam grades a trusted cell, which is a check cell."""
    marks = marks_of(cell)
    return bool(marks.get('grade')) and not marks.get('solution') and cell['cell_type'] == 'code'


def grade_ids(notebook: Notebook) -> frozenset[str]:
    """Return the grade ids of a trusted notebook."""
    return frozenset(marks_of(cell).get('grade_id', '') for cell in notebook['cells']) - {''}


def by_grade_id(cells: Iterable[StudentCell]) -> dict[str, list[StudentCell]]:
    """Return all cells with each grade id, in their order."""
    found: dict[str, list[StudentCell]] = {}
    for cell in cells:
        found.setdefault(cell.grade_id, []).append(cell)
    return found


def read_release(path: Path) -> Notebook:
    """Return a notebook of the course with one string per cell; raise an OSError or ValueError."""
    notebook = json.loads(path.read_text(encoding='utf-8'))
    if not isinstance(notebook, dict) or not isinstance(notebook.get('cells'), list):
        raise ValueError(f'{path.name} is not a notebook in format 4')
    for cell in notebook['cells']:
        cell['source'] = ''.join(cell['source'])
    return notebook


MARKS = ('grade', 'solution', 'locked', 'points', 'task')
"""Fields of nbgrader's metadata that determine how a cell is graded."""
_NUMBERS = {number / 20: number / 20 for number in range(20001)}
"""Usual points, in steps of 0.05; they are shared objects, because a file may contain millions."""


def small_number(text: str) -> float | bool:
    """Return a number in a file if it can be the points of a cell; True for any other number."""
    return _NUMBERS.get(float(text), True) if len(text) < 12 else True
