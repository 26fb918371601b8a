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
"""Limit of files in a class, not counting files that programs generate."""
MOST_LISTED = 10 * MOST_ENTRIES
"""Limit of all names in a source, including files that programs generate."""
MOST_BYTES = 2 << 30
"""Limit of all bytes read from one source, unpacked; a class has a few hundred megabytes."""
LONGEST_NAME = 400
REPOSITORY = '.git'
NOISE = frozenset(
    {'__MACOSX', '.DS_Store', '.ipynb_checkpoints', REPOSITORY, '.venv', '__pycache__'}
)
"""
Names made by macOS, Jupyter, git and Python; macOS also makes ``._NAME``, even of a notebook.
"""
BUILT = frozenset({'build', 'install', 'log'})
"""
Folders made by colcon, if they contain its mark or are in the workspace of the lessons; a student
may use the same names.  Notebooks elsewhere in a workspace are listed.
"""
_WORKSPACE = 'ros_ws'


def opened(source: Path) -> AbstractContextManager[Tree]:
    """
    Yield a class whose files can be read in the context.

    :raises NotTakenInError: if it is neither a folder nor a zip, damaged, or too large
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
