"""
Open the source of a class, with limits for its size and without generated files.

Files that programs generate next to the work are neither listed nor counted.  Otherwise the built
workspace of one student could exceed the limits for the whole class.
"""

from __future__ import annotations

from collections.abc import Collection
from contextlib import AbstractContextManager
from pathlib import Path

from autograder.submission import tree
from autograder.submission.notebook import MAX_BYTES
from autograder.submission.tree import Bounds, Parts, Tree

MOST_ENTRIES = 50_000
"""Maximum number of files in a source, without generated files."""
MOST_LISTED = 10 * MOST_ENTRIES
"""Maximum number of names in a source, including generated files."""
MOST_BYTES = 2 << 30
"""Maximum number of unpacked bytes read from a source; a class has a few hundred megabytes."""
LONGEST_NAME = 400
REPOSITORY = '.git'
NOISE = frozenset(
    {'__MACOSX', '.DS_Store', '.ipynb_checkpoints', REPOSITORY, '.venv', '__pycache__'}
)
"""
Files and folders that macOS, Jupyter, git and Python generate.

macOS also generates ``._NAME`` files, even for notebooks.
"""
BUILT = frozenset({'build', 'install', 'log'})
"""
Folders that colcon generates.

Students may use these names too, so such a folder is skipped only if it contains colcon's marker
file or is directly in the workspace of the lessons.
"""
_WORKSPACE = 'ros_ws'


def opened(source: Path) -> AbstractContextManager[Tree]:
    """
    Open a source in a context, in which its files can be read.

    :raises NotTakenInError: if the source is neither a folder nor a zip, is damaged or too large
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
