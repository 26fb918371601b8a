"""
Open the source of a class: limits for its size, and files that do not count as work.

Files that programs generate next to the work are neither listed nor counted, because a student's
workspace must not make a class too large.
"""

from __future__ import annotations

from collections.abc import Collection
from contextlib import AbstractContextManager
from pathlib import Path

from autograder.submission import tree
from autograder.submission.notebook import MAX_BYTES
from autograder.submission.tree import Bounds, Parts, Tree

MOST_ENTRIES = 50_000
"""Of the class; what programs leave is not counted here."""
MOST_LISTED = 10 * MOST_ENTRIES
"""Bound on all names that are looked at, whatever they are."""
MOST_BYTES = 2 << 30
"""Bound on all that is read of one source, unpacked: a class has some hundred megabytes."""
LONGEST_NAME = 400
REPOSITORY = '.git'
NOISE = frozenset(
    {'__MACOSX', '.DS_Store', '.ipynb_checkpoints', REPOSITORY, '.venv', '__pycache__'}
)
"""
Made by macOS, Jupyter, git and Python; ``._NAME`` is macOS's too, and may end in ``.ipynb``.
"""
BUILT = frozenset({'build', 'install', 'log'})
"""
Made by colcon, if its mark is in it or it lies in the workspace of the lessons: the names alone
may be somebody's own.  Notebooks elsewhere in a workspace are listed as everywhere.
"""
_WORKSPACE = 'ros_ws'


def opened(source: Path) -> AbstractContextManager[Tree]:
    """
    Yield a class whose files can be read in the context.

    :raises NotTakenInError: if it is neither folder nor zip, broken, or far too much
    """
    bounds = Bounds(
        'the submissions of a class',
        'a folder with submissions only, one assignment at a time, or part of the class',
        _is_noise,
        entries=MOST_ENTRIES,
        listed=MOST_LISTED,
        file_bytes=MAX_BYTES,
        whole_bytes=MOST_BYTES,
        name_chars=LONGEST_NAME,
    )
    return tree.opened(source, bounds)


def _is_noise(parts: Parts, marked: Collection[Parts]) -> bool:
    *above, name = parts
    built = name in BUILT and above and (above[-1] == _WORKSPACE or parts in marked)
    return name in NOISE or name.startswith('._') or bool(built)
