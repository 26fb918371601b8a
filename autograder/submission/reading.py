"""Read a file from a student or another system safely: no links, devices or huge files."""

import os
from pathlib import Path
import stat

from autograder.results import Problem
from autograder.submission.notebook import MAX_BYTES, too_large

SUBMIT_AGAIN = 'ask the student to submit again'


def read_file(
    path: Path, where: str, owner: int | None = None
) -> tuple[bytes | None, tuple[Problem, ...]]:
    """
    Read a regular file without following links or waiting for a pipe.

    :param where: name of the file in messages
    :param owner: required uid of the file's owner, None for any owner
    :returns: the content, None if it cannot be read; and the problems
    """
    try:
        kind = os.lstat(path).st_mode
        if not stat.S_ISREG(kind):
            got = 'a symbolic link' if stat.S_ISLNK(kind) else 'something else'
            return None, (Problem(where, 'a regular file', got, SUBMIT_AGAIN),)
        # The file may have been replaced since lstat, so check the opened file again.
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with os.fdopen(descriptor, 'rb') as file:
            now = os.fstat(descriptor)
            if not stat.S_ISREG(now.st_mode):
                return None, (Problem(where, 'a regular file', 'something else', SUBMIT_AGAIN),)
            if owner not in (None, now.st_uid):
                got = 'a file that another user put in its place'
                return None, (Problem(where, 'the file that was listed', got, SUBMIT_AGAIN),)
            if now.st_size > MAX_BYTES:
                return None, (too_large(where, now.st_size),)
            return file.read(now.st_size + 1), ()  # read() allocates as much memory as requested
    except OSError as error:
        return None, (unreadable(where, error),)


def unreadable(where: str, error: OSError) -> Problem:
    """Return the problem of a file that the operating system cannot read."""
    reason = (error.strerror or type(error).__name__).lower()
    return Problem(where, 'a readable file or folder', reason, 'check its permissions')
