"""Read nbgrader's settings for the course without nbgrader, whose import takes seconds."""

from __future__ import annotations

from pathlib import Path

from traitlets.config import Config
from traitlets.config.loader import PyFileConfigLoader

from autograder.errors import GraderError
from autograder.layout import Layout


def load_config(layout: Layout) -> Config:
    """
    Return the settings in the course's ``nbgrader_config.py``.

    :raises GraderError: if the file is missing or raises an exception
    """
    path = layout.root / 'nbgrader_config.py'
    if not path.is_file():
        raise GraderError(f'{path.name} is missing in {layout.root}.', 'Restore it from git.')
    try:
        return PyFileConfigLoader(path.name, path=str(layout.root)).load_config()
    except Exception as error:  # noqa: BLE001 - The file is Python code that instructors edit.
        raise GraderError(
            f'{path}: nbgrader cannot read these settings: {type(error).__name__}: {error}.',
            'Try: fix the file, then run the same command again. Finished runs are kept.',
        ) from error


def gradebook_file(layout: Layout) -> Path | None:
    """Return the path of the gradebook, which may not exist; None for a gradebook on a server."""
    place, found, path = str(load_config(layout).CourseDirectory.db_url).partition('sqlite:///')
    return Path(path) if found and not place else None


def has_gradebook(layout: Layout) -> bool:
    """Return whether the gradebook exists; for a gradebook on a server, always return True."""
    path = gradebook_file(layout)
    return path is None or path.is_file()
