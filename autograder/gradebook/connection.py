"""Query the gradebook without nbgrader, whose import takes seconds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from sqlalchemy import Connection, create_engine, inspect, make_url
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, SQLAlchemyError
from sqlalchemy.pool import NullPool

from autograder.errors import GraderError
from autograder.gradebook.copies import copies, refuse_damaged
from autograder.gradebook.settings import gradebook_file, has_gradebook, load_config
from autograder.layout import Layout

INCOMPLETE = ('no such table', 'no such column', 'not a database', 'malformed')
FILE_ADVICE = {
    'disk is full': 'free space on its disk',
    'is locked': 'close the program that uses it (formgrader, a database browser)',
    **dict.fromkeys(INCOMPLETE, 'put a complete copy of the file in its place'),
}
"""Advice for a gradebook file that fails, by a part of SQLite's error message."""


class GradebookRefusedError(GraderError):
    """The database of the gradebook failed, so no submission can be entered."""


def database_failure(error: BaseException) -> SQLAlchemyError | None:
    """
    Return the database error that caused an error of nbgrader, or None.

    An invalid value in one row is not a failure of the database.
    """
    seen: BaseException | None = error
    while seen is not None:
        if isinstance(seen, DBAPIError) and not isinstance(seen, (DataError, IntegrityError)):
            found: SQLAlchemyError = seen
            return found
        seen = seen.__cause__ or seen.__context__
    return None


def refusal(layout: Layout, error: SQLAlchemyError) -> GradebookRefusedError:
    """Return the error for a failure of the database."""
    return refused(layout, str(getattr(error, 'orig', None) or error))


def refused(layout: Layout, said: str) -> GradebookRefusedError:
    """
    Return the error for an unusable gradebook, with its address, the problem and a remedy.

    :param said: the message of the database; only its first line is used
    """
    said = said.strip().partition('\n')[0].rstrip('.')
    path = gradebook_file(layout)
    if path is not None:
        known = (advice for part, advice in FILE_ADVICE.items() if part in said)
        where = str(path)
        advice = next(known, 'check the file, its folder and their permissions')
        if there := copies(layout):
            advice = advice.replace('a complete copy of the file', str(there[-1]))
    else:
        url = make_url(str(load_config(layout).CourseDirectory.db_url))
        where = url.render_as_string(hide_password=True)
        advice = 'check that the database server is running and that its gradebook is complete'
    return GradebookRefusedError(
        f'{where}: the gradebook cannot be used: {said}.',
        f'Try: {advice}, then run the same command again. Finished runs are kept.',
    )


@contextmanager
def connected(layout: Layout) -> Iterator[Connection | None]:
    """
    Yield a connection to the gradebook, or None if the file does not exist yet.

    This never creates a gradebook.

    :raises GraderError: if the gradebook cannot be reached or read; the error shows its address
        without the password
    """
    if not has_gradebook(layout):
        yield None
        return
    refuse_damaged(layout)
    address = 'c.CourseDirectory.db_url'
    try:
        url = make_url(str(load_config(layout).CourseDirectory.db_url))
        address = url.render_as_string(hide_password=True)
        engine = create_engine(url, poolclass=NullPool)
    except (SQLAlchemyError, ValueError) as error:
        raise GraderError(
            f'{address}: this is not the address of a gradebook: {error}.',
            'Try: set c.CourseDirectory.db_url in nbgrader_config.py as docs/gradebook.md shows, '
            'then run the same command again. Finished runs are kept.',
        ) from error
    except ModuleNotFoundError as error:
        raise GraderError(
            f'{address}: the driver {error.name} for this gradebook is not installed.',
            'Try: .venv/bin/python -m pip install --no-deps -r '
            'environment/requirements-postgres.txt (see docs/gradebook.md)',
        ) from error
    try:
        with engine.connect() as gradebook:
            yield gradebook
    except SQLAlchemyError as error:
        raise refusal(layout, error) from error


def query(layout: Layout, statement: Any, table: str = 'grade', **values: str) -> Sequence[Any]:
    """
    Return the rows of a query; none if the gradebook or a table does not exist yet.

    :param table: the query returns no rows if this table does not exist
    :param values: values of the statement's parameters
    :raises GraderError: if the gradebook cannot be queried
    """
    with connected(layout) as gradebook:
        if gradebook is None or not inspect(gradebook).has_table(table):
            return ()
        return gradebook.execute(statement, values).all()
