"""
Keep dated copies of the gradebook, and refuse a gradebook that has lost its content.

Manual grades exist only in the gradebook.  A gradebook on a server is not copied; see
``docs/gradebook.md``.
"""

from __future__ import annotations

from contextlib import closing
import os
from pathlib import Path
import shlex
import sqlite3
import time

from sqlalchemy import make_url

from autograder.errors import GraderError
from autograder.gradebook.settings import gradebook_file, load_config
from autograder.layout import Layout

MAX_RECENT = 10
MAX_DAYS = 10
MAX_BYTES = 500_000_000
"""Maximum size of all copies together [bytes]; the newest copy is kept, whatever its size."""
_NAME = '%Y-%m-%d_%H%M%SZ.db'
_DAY_CHARS = len('2026-12-31')


def copies_folder(layout: Layout) -> Path:
    """Return the folder that contains the copies of the gradebook."""
    return layout.work / 'gradebook_copies'


def copies(layout: Layout) -> list[Path]:
    """Return the copies, oldest first."""
    return sorted(copies_folder(layout).glob('[0-9]*Z.db'))


def keep_copy(layout: Layout) -> Path | None:
    """
    Copy the gradebook, and remove old copies.

    :returns: path of a copy with the current content; None if the gradebook is on a server or has
        no submission
    :raises GraderError: if the gradebook is damaged, or no copy can be written
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
    unfinished = copy.with_name('unfinished')  # A fixed name is safe: only one grading runs.
    try:
        with closing(sqlite3.connect(path)) as book:
            if _is_empty(book):
                return None
        copy.parent.mkdir(exist_ok=True)
        unfinished.unlink(missing_ok=True)
        _copy(path, unfinished)
        os.utime(unfinished, ns=(changed_ns, changed_ns))
        unfinished.replace(copy)
    except (sqlite3.Error, OSError) as error:
        unfinished.unlink(missing_ok=True)
        if type(error) is sqlite3.DatabaseError:  # Temporary failures raise a subclass.
            raise _damaged(layout, path, str(error)) from error
        raise GraderError(
            f'{path}: the gradebook cannot be copied: {error}. Nothing was entered.',
            f'Try: free space for {copy.parent}, close other programs that write to the '
            'gradebook, then run the same command again. Finished runs are kept.',
        ) from error
    _remove_old(copies(layout))
    return copy


def _copy(path: Path, to: Path) -> None:
    """Check the integrity of the gradebook, and write a copy to disk."""
    with closing(sqlite3.connect(path)) as book:
        (said,) = book.execute('pragma quick_check(1)').fetchone()
        if said != 'ok':
            raise sqlite3.DatabaseError(' '.join(said.split()))
        # VACUUM INTO fails if the gradebook is locked; Connection.backup() would wait forever.
        book.execute('vacuum into ?', (str(to),))
    with to.open('rb') as file:
        os.fsync(file.fileno())


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

    :raises GraderError: if the file is refused; the error names the newest copy, if there is one
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
        if not empty or not (_was_filled(layout) or (nothing and copies(layout))):
            return
        got = 'an empty file' if nothing else 'it no longer has any submissions'
    raise _damaged(layout, path, got)


def _is_empty(book: sqlite3.Connection) -> bool:
    """Return whether a gradebook has no submission."""
    tables = "select count(*) from sqlite_master where name = 'submitted_assignment'"
    if not book.execute(tables).fetchone()[0]:
        return True
    return book.execute('select count(*) from submitted_assignment').fetchone() == (0,)


def _was_filled(layout: Layout) -> bool:
    """Return whether submissions were entered in the current gradebook."""
    journals = (layout.work / 'entered').glob('*.jsonl')
    return any(journal.read_bytes().strip() for journal in journals)


def _damaged(layout: Layout, path: Path, got: str) -> GraderError:
    """Return the error for a damaged gradebook; it names the newest copy."""
    fix = 'restore it from a backup, because the grader has no copy'
    if there := copies(layout):
        fix = f'cp {shlex.quote(str(there[-1]))} {shlex.quote(str(path))}'
    return GraderError(
        f'{path}: the gradebook is damaged: {got}.',
        f'Try: {fix}. To begin a new gradebook instead, remove the file. Nothing was written.',
    )


def how_to_dump(layout: Layout) -> str:
    """Return how to dump a gradebook on a server; empty for a file, which the grader copies."""
    if gradebook_file(layout) is not None:
        return ''
    url = make_url(str(load_config(layout).CourseDirectory.db_url))
    plain = url.set(drivername=url.get_backend_name(), password=None).render_as_string()
    return (
        'The gradebook is on a server and not copied here; before --yes: pg_dump --format=custom '
        f'--file=gradebook.dump {shlex.quote(plain)}'
    )
