"""
The database of the gradebook: its settings, a connection, and dated copies of the file.

Nothing here imports nbgrader, which takes seconds.  Manual grades exist only in the gradebook, so
a gradebook that has lost its content is refused.  A gradebook on a server is not copied; see
``docs/gradebook.md``.
"""

from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from difflib import get_close_matches
import os
from pathlib import Path
import shlex
import sqlite3
import time
from typing import Any

from sqlalchemy import Connection, create_engine, inspect, make_url, text
from sqlalchemy.exc import DataError, DBAPIError, IntegrityError, SQLAlchemyError
from sqlalchemy.pool import NullPool
from traitlets.config import Config
from traitlets.config.loader import PyFileConfigLoader

from autograder.classroom.results_of_class import has_mark
from autograder.errors import GraderError
from autograder.layout import Layout
from autograder.results import SubmissionResult
from autograder.submission.notebook import CHECK_PREFIX

MAX_RECENT = 10
MAX_DAYS = 10
MAX_BYTES = 500_000_000
"""Maximum size of all copies together [bytes]; the newest copy is kept, whatever its size."""
_NAME = '%Y-%m-%d_%H%M%SZ.db'
_DAY_CHARS = len('2026-12-31')
INCOMPLETE = ('no such table', 'no such column', 'not a database', 'malformed')
FILE_ADVICE = {
    'disk is full': 'free space on its disk',
    'is locked': 'close the program that uses it (formgrader, a database browser)',
    **dict.fromkeys(INCOMPLETE, 'put a complete copy of the file in its place'),
}
"""Advice for a gradebook file that fails, by a part of SQLite's error message."""
WAITING = """
select assignment.name, submitted_assignment.student_id, base_cell.name
from grade
join base_cell on base_cell.id = grade.cell_id
join submitted_notebook on submitted_notebook.id = grade.notebook_id
join submitted_assignment on submitted_assignment.id = submitted_notebook.assignment_id
join assignment on assignment.id = submitted_assignment.assignment_id
where grade.needs_manual_grade
"""
"""Select the cells without a mark: written answers, and check cells *for review*."""
WITHOUT_WORK = """
select name from assignment where not exists (
    select 1 from submitted_assignment where submitted_assignment.assignment_id = assignment.id)
order by name
"""


def settings_files(layout: Layout) -> list[Path]:
    """Return the existing settings: the course's, and those of this class, which git ignores."""
    there = (folder / 'nbgrader_config.py' for folder in (layout.root, layout.work))
    return [path for path in there if path.is_file()]


def load_config(layout: Layout) -> Config:
    """Return the settings in ``nbgrader_config.py``; raise a GraderError if they are unusable."""
    path = layout.root / 'nbgrader_config.py'
    if not path.is_file():
        raise GraderError(f'{path.name} is missing in {layout.root}.', 'Restore it from git.')
    try:
        return PyFileConfigLoader(path.name, path=str(layout.root)).load_config()
    except Exception as error:  # noqa: BLE001 - The file is Python code that instructors edit.
        raise GraderError(
            f'{" or ".join(map(str, settings_files(layout)))}: nbgrader cannot read these '
            f'settings: {type(error).__name__}: {error}.',
            'Try: fix the file, then run the same command again. Finished runs are kept.',
        ) from error


def address(layout: Layout) -> str:
    """Return the URL of the gradebook, which may contain a password."""
    return str(load_config(layout).CourseDirectory.db_url)


def gradebook_file(layout: Layout) -> Path | None:
    """Return the path of the gradebook, which may not exist; None for a gradebook on a server."""
    place, found, path = address(layout).partition('sqlite:///')
    return Path(path) if found and not place else None


def has_gradebook(layout: Layout) -> bool:
    """Return whether the gradebook exists; for a gradebook on a server, always return True."""
    path = gradebook_file(layout)
    return path is None or path.is_file()


# -- a connection ---------------------------------------------------------------------------


def database_failure(error: BaseException) -> SQLAlchemyError | None:
    """Return the failure of the database behind an error, if any; an invalid value is none."""
    seen: BaseException | None = error
    while seen is not None:
        if isinstance(seen, DBAPIError) and not isinstance(seen, (DataError, IntegrityError)):
            return seen
        seen = seen.__cause__ or seen.__context__
    return None


def refusal(layout: Layout, error: Exception | str) -> GraderError:
    """Return the error for an unusable gradebook: address, first line of the problem, remedy."""
    said = str(getattr(error, 'orig', None) or error).strip().partition('\n')[0].rstrip('.')
    path = gradebook_file(layout)
    if path is not None:
        known = (advice for part, advice in FILE_ADVICE.items() if part in said)
        where = str(path)
        advice = next(known, 'check the file, its folder and their permissions')
        if there := copies(layout):
            advice = advice.replace('a complete copy of the file', str(there[-1]))
    else:
        where = make_url(address(layout)).render_as_string(hide_password=True)
        advice = 'check that the database server is running and that its gradebook is complete'
    return GraderError(
        f'{where}: the gradebook cannot be used: {said}.',
        f'Try: {advice}, then run the same command again. Finished runs are kept.',
    )


@contextmanager
def connected(layout: Layout) -> Iterator[Connection | None]:
    """Yield a connection, None if there is no gradebook; never create one or show a password."""
    if not has_gradebook(layout):
        yield None
        return
    refuse_damaged(layout)
    where = 'c.CourseDirectory.db_url'
    try:
        url = make_url(address(layout))
        where = url.render_as_string(hide_password=True)
        engine = create_engine(url, poolclass=NullPool)
    except (SQLAlchemyError, ValueError) as error:
        raise GraderError(
            f'{where}: this is not the address of a gradebook: {error}.',
            'Try: set c.CourseDirectory.db_url in autograder/_work/nbgrader_config.py as '
            'docs/gradebook.md shows, then run the same command again. Finished runs are kept.',
        ) from error
    except ModuleNotFoundError as error:
        raise GraderError(
            f'{where}: the driver {error.name} for this gradebook is not installed.',
            'Try: .venv/bin/python -m pip install --no-deps -r '
            'environment/requirements-postgres.txt (see docs/gradebook.md)',
        ) from error
    try:
        with engine.connect() as gradebook:
            yield gradebook
    except SQLAlchemyError as error:
        raise refusal(layout, error) from error


def query(layout: Layout, statement: Any, table: str = 'grade', **values: str) -> Sequence[Any]:
    """Return the rows of a query; none if the gradebook or the table does not exist yet."""
    with connected(layout) as gradebook:
        if gradebook is None or not inspect(gradebook).has_table(table):
            return ()
        return gradebook.execute(statement, values).all()


def to_grade_by_hand(
    layout: Layout, assignment: str, results: Iterable[SubmissionResult]
) -> list[str]:
    """
    Return the students with points from checks whose other answers wait for manual grading.

    An unusable gradebook gives none: the commands that write to it report the reason.
    """
    rows: Sequence[Any] = ()
    with suppress(GraderError):
        rows = query(layout, text(WAITING))
    waiting = {str(student) for name, student, _ in rows if name == assignment}
    return [one.student for one in results if has_mark(one) and one.student in waiting]


def notes_for_instructor(layout: Layout) -> list[str]:
    """Return sentences about answers that wait for a mark, and about unknown assignments."""
    notes = []
    rows = query(layout, text(WAITING))
    if written := sum(not cell.startswith(CHECK_PREFIX) for _, _, cell in rows):
        notes.append(
            f'Written answers to mark: {written}. Try: make lab, Nbgrader > Formgrader > Manual '
            'Grading'
        )
    for (name,) in query(layout, text(WITHOUT_WORK), 'assignment'):
        if name not in (known := layout.assignments()):
            close = get_close_matches(name, known, n=1)
            meant = f'; did you mean {close[0]}?' if close else '.'
            notes.append(
                f'gradebook: {name} is not an assignment of this course{meant} Try: '
                f'.venv/bin/nbgrader db assignment remove {shlex.quote(name)}'
            )
    return notes


# -- copies ---------------------------------------------------------------------------------


def copies_folder(layout: Layout) -> Path:
    """Return the folder that contains the copies of the gradebook."""
    return layout.work / 'gradebook_copies'


def copies(layout: Layout) -> list[Path]:
    """Return the copies, oldest first."""
    return sorted(copies_folder(layout).glob('[0-9]*Z.db'))


def save_copy(layout: Layout) -> Path | None:
    """
    Copy the gradebook, and remove old copies.

    :returns: path of a copy with the current content; None if the gradebook is on a server or has
        no submission
    """
    path = gradebook_file(layout)
    if path is None or not path.is_file():
        return None
    refuse_damaged(layout)
    there = copies(layout)
    changed_ns = path.stat().st_mtime_ns
    if there and there[-1].stat().st_mtime_ns == changed_ns:
        return there[-1]
    copy = copies_folder(layout) / time.strftime(_NAME, time.gmtime())
    unfinished = copy.with_name('unfinished')  # A fixed name is safe: the course is locked.
    try:
        if not _copy(path, unfinished):
            return None
        os.utime(unfinished, ns=(changed_ns, changed_ns))
        unfinished.replace(copy)
    except (sqlite3.Error, OSError) as error:
        unfinished.unlink(missing_ok=True)
        if type(error) is sqlite3.DatabaseError:  # Temporary failures raise a subclass.
            raise _damaged(layout, path, str(error)) from error
        raise GraderError(
            f'{path}: the gradebook cannot be copied: {error}. Nothing was entered.',
            f'Try: free some space on the disk of {copy.parent}, close other programs that write '
            'to the gradebook, then run the same command again. Finished runs are kept.',
        ) from error
    _remove_old(copies(layout))
    return copy


def _copy(path: Path, to: Path) -> bool:
    """Check the integrity of the gradebook, and write a copy to disk unless it is empty."""
    with closing(sqlite3.connect(path)) as book:
        if _is_empty(book):
            return False
        to.parent.mkdir(exist_ok=True)
        to.unlink(missing_ok=True)
        (said,) = book.execute('pragma quick_check(1)').fetchone()
        if said != 'ok':
            raise sqlite3.DatabaseError(' '.join(said.split()))
        # VACUUM INTO fails if the gradebook is locked; Connection.backup() would wait forever.
        book.execute('vacuum into ?', (str(to),))
    with to.open('rb') as file:
        os.fsync(file.fileno())
    return True


def _remove_old(there: list[Path]) -> None:
    """Remove all copies except the newest ones and the first copy of each recent day."""
    days: dict[str, Path] = {}
    for path in there:
        days.setdefault(path.name[:_DAY_CHARS], path)
    kept = {*there[-MAX_RECENT:], *list(days.values())[-MAX_DAYS:]}
    size = 0
    for path in reversed(there):
        size += path.stat().st_size if path in kept else 0
        if path not in kept or (size > MAX_BYTES and path != there[-1]):
            path.unlink()


def refuse_damaged(layout: Layout) -> None:
    """
    Refuse a gradebook file that is damaged, or is empty although it had submissions before.

    A missing file is accepted: an instructor removes the file to start a new gradebook.
    """
    path = gradebook_file(layout)
    if path is None or not path.is_file():
        return
    try:
        with closing(sqlite3.connect(path)) as book:
            empty = _is_empty(book)
    except sqlite3.OperationalError:
        return  # The file may be locked; the first query reports this.
    except sqlite3.DatabaseError as error:
        got = str(error)
    else:
        nothing = not path.stat().st_size
        journals = (layout.work / 'entered').glob('*.json*')  # Earlier versions wrote .jsonl.
        was_filled = any(one.read_bytes().strip() not in (b'', b'{}') for one in journals)
        if not empty or not (was_filled or (nothing and copies(layout))):
            return
        got = 'the file is empty' if nothing else 'it no longer has any submissions'
    raise _damaged(layout, path, got)


def _is_empty(book: sqlite3.Connection) -> bool:
    """Return whether a gradebook has no submission."""
    tables = "select count(*) from sqlite_master where name = 'submitted_assignment'"
    if not book.execute(tables).fetchone()[0]:
        return True
    return book.execute('select count(*) from submitted_assignment').fetchone() == (0,)


def _damaged(layout: Layout, path: Path, got: str) -> GraderError:
    """Return the error for a damaged gradebook; it names the newest copy."""
    fix = 'restore it from a backup, because the grader has no copy'
    if there := copies(layout):
        fix = f'cp {shlex.quote(str(there[-1]))} {shlex.quote(str(path))}'
    return GraderError(
        f'{path}: the gradebook is damaged: {got}.',
        f'Try: {fix}. To begin a new gradebook instead, remove the file. Nothing was written.',
    )


def dump_instructions(layout: Layout) -> str:
    """Return instructions for dumping a gradebook on a server; empty for a gradebook file."""
    if gradebook_file(layout) is not None:
        return ''
    url = make_url(address(layout))
    plain = url.set(drivername=url.get_backend_name(), password=None).render_as_string()
    return (
        'The gradebook is on a server and not copied here. Before you use --yes, run: pg_dump '
        f'--format=custom --file=gradebook.dump {shlex.quote(plain)}'
    )
