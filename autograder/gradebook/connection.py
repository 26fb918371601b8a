"""The gradebook, asked directly: nbgrader takes seconds to import, and a rerun seldom needs it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from autograder.errors import GraderError
from autograder.gradebook.settings import gradebook_file, load_config
from autograder.layout import Layout

if TYPE_CHECKING:
    from sqlalchemy import Connection


@contextmanager
def connected(layout: Layout) -> Iterator[Connection | None]:
    """
    Yield a connection to the gradebook, None if it is a file that is not there yet.

    None is made by looking.

    :raises GraderError: if it cannot be reached or read, with its address but no password
    """
    from sqlalchemy import create_engine, make_url
    from sqlalchemy.exc import SQLAlchemyError
    from sqlalchemy.pool import NullPool

    path = gradebook_file(layout)
    if path is not None and not path.is_file():
        yield None
        return
    address = 'c.CourseDirectory.db_url'
    try:
        url = make_url(str(load_config(layout).CourseDirectory.db_url))
        address = url.render_as_string(hide_password=True)
        engine = create_engine(url, poolclass=NullPool)
    except (SQLAlchemyError, ValueError) as error:
        raise GraderError(
            f'{address}: expected the address of a gradebook, got: {error}.',
            'Try: c.CourseDirectory.db_url in nbgrader_config.py as in docs/gradebook.md, then '
            'the same command again; no run is lost.',
        ) from error
    except ModuleNotFoundError as error:
        raise GraderError(
            f'{address}: expected the driver {error.name} for this gradebook, got none.',
            'Try: .venv/bin/python -m pip install --no-deps -r '
            'environment/requirements-postgres.txt (see docs/gradebook.md)',
        ) from error
    try:
        with engine.connect() as gradebook:
            yield gradebook
    except SQLAlchemyError as error:
        said = str(error).strip().splitlines()[0]
        raise GraderError(
            f'{address}: expected a gradebook that answers, got: {said}.',
            'Try: see that its server runs and c.CourseDirectory.db_url in nbgrader_config.py is '
            'right, then the same command again; no run is lost.',
        ) from error
