"""Lock a course: only one command at a time writes its submissions, gradebook and reports."""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
import fcntl
import os
import re
import time

from autograder.errors import GraderError
from autograder.layout import Layout

UNFINISHED = re.compile(r'\..+\.[0-9a-f]{32}')
"""Name of a file that :func:`autograder.files.write_atomically` has not finished writing."""


@contextmanager
def lock_course(layout: Layout, what: str) -> Iterator[None]:
    """
    Lock the course for this process, and remove files that a killed command left unfinished.

    The kernel releases the lock when the process ends, even if it is killed.  The text in the lock
    file only describes the process.

    :param what: name of the command, shown by a second process that needs the lock
    :raises GraderError: if another process holds the lock; the error names that process
    """
    layout.work.mkdir(parents=True, exist_ok=True)
    path = layout.work / 'lock'
    path.touch(0o600)
    with path.open('r+', encoding='utf-8', errors='replace') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise GraderError(
                f'{path}: another command is writing to this course: '
                f'{lock.read(200) or "name unknown"}.',
                'Try: wait until it ends, or stop it with Ctrl-C in its terminal',
            ) from error
        if lock.read():  # The previous command was killed.
            _remove_stale_files(layout)
        lock.truncate(0)
        lock.seek(0)
        lock.write(f'{what} since {time.strftime("%H:%M")}, process {os.getpid()}')
        lock.flush()
        yield
        lock.truncate(0)


def _remove_stale_files(layout: Layout) -> None:
    """Remove unfinished files that no process is writing."""
    for folder in (layout.reports, layout.recordings):
        for path in filter(lambda path: UNFINISHED.fullmatch(path.name), folder.glob('*/.*')):
            # An OSError means that the file is gone, or that its writer still has it locked.
            with suppress(OSError), path.open('rb') as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                path.unlink()
