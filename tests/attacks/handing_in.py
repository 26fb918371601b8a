"""What the files in ``notebooks/`` have in common: cells, and laying out what is handed in."""

from __future__ import annotations

from collections.abc import Iterator
import json
from pathlib import Path
from typing import Any

ASSIGNMENT = '07_temperature_monitor'
NOTEBOOK = 'temperature_monitor.ipynb'
PAYLOAD = Path('/tmp/an-attack-of-the-corpus-ran')
"""What a payload makes where it is executed; nobody else does."""

Notebook = dict[str, Any]


def cell(notebook: Notebook, grade_id: str) -> dict[str, Any]:
    """Return the cell of a grade id."""
    return next(one for one in marked(notebook) if grade_id_of(one) == grade_id)


def marked(notebook: Notebook) -> Iterator[dict[str, Any]]:
    """Yield the cells that nbgrader knows."""
    yield from (one for one in notebook['cells'] if 'nbgrader' in one['metadata'])


def checks(notebook: Notebook) -> Iterator[dict[str, Any]]:
    """Yield the cells of automatic checks."""
    yield from (one for one in marked(notebook) if grade_id_of(one).startswith('check_'))


def grade_id_of(one: dict[str, Any]) -> str:
    """Return the grade id of a cell that nbgrader knows."""
    return str(one['metadata']['nbgrader']['grade_id'])


def code(source: str) -> dict[str, Any]:
    """Return a code cell that nbgrader does not know."""
    return {
        'cell_type': 'code',
        'id': f'x{abs(hash(source))}',
        'metadata': {},
        'source': source,
        'outputs': [],
        'execution_count': None,
    }


def lay_out(student: Path, content: Notebook | str | bytes, name: str = NOTEBOOK) -> Path:
    """
    Write what is handed in where nbgrader's collect would.

    :param student: the student's folder
    :returns: the folder of the assignment
    """
    folder = student / ASSIGNMENT
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(content) if isinstance(content, dict) else content
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    return folder
