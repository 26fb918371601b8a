"""
Register malicious submissions, and create their cells and folders.

``hostile_notebooks.py`` and ``hostile_folders.py`` register functions.  Each gets the
student's folder, the solved notebook and the released one.  It returns the content of the
notebook's file, or lays out the folder itself.  Its docstring says what it tries.
"""

from collections.abc import Callable, Iterator
import json
from pathlib import Path
from typing import Any

from tests.attacks.corpus import Attack, NOTEBOOKS

ASSIGNMENT = '07_temperature_monitor'
NOTEBOOK = 'temperature_monitor.ipynb'
PAYLOAD = Path('/tmp/an-attack-of-the-corpus-ran')
"""A file that exists only if a payload was executed."""

Notebook = dict[str, Any]
Content = Notebook | str | bytes
HandIn = Callable[[Path, Notebook, Notebook], Content | None]

HANDED_IN: dict[str, tuple[Attack, HandIn]] = {}
"""The description of each attack and the function that creates its submission, by name."""


def attack(stopped_by: str, points: float, *flags: str) -> Callable[[HandIn], HandIn]:
    """
    Register a function in :data:`HANDED_IN`.

    :param points: the points of lesson 07 that it deserves
    :param flags: words that the instructor must see
    """

    def enter(function: HandIn) -> HandIn:
        tries = ' '.join((function.__doc__ or '').split())
        about = Attack(function.__name__, NOTEBOOKS, tries, stopped_by, points, flags=flags)
        HANDED_IN[about.name] = about, function
        return function

    return enter


def cell(notebook: Notebook, grade_id: str) -> dict[str, Any]:
    return next(one for one in marked(notebook) if grade_id_of(one) == grade_id)


def marked(notebook: Notebook) -> Iterator[dict[str, Any]]:
    """Yield the cells that nbgrader knows."""
    yield from (one for one in notebook['cells'] if 'nbgrader' in one['metadata'])


def checks(notebook: Notebook) -> Iterator[dict[str, Any]]:
    yield from (one for one in marked(notebook) if grade_id_of(one).startswith('check_'))


def grade_id_of(one: dict[str, Any]) -> str:
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


def lay_out(student: Path, content: Content, name: str = NOTEBOOK) -> Path:
    """
    Write a submission to the folder that nbgrader's collect would use.

    :param student: the student's folder
    :returns: the folder of the assignment
    """
    folder = student / ASSIGNMENT
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(content) if isinstance(content, dict) else content
    (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)
    return folder
