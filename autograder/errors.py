"""
Define the exceptions for faults of the grader: :class:`GraderError` and its subclasses.

Further subclasses are in ``submission/reading.py`` and ``grading/cluster.py``.

A mistake in a *submission* never leaves this package as an exception: it is a
:class:`~autograder.results.Problem` or a failed check.
"""

import errno
from pathlib import Path
from traceback import walk_tb


class GraderError(Exception):
    """
    Report that the grader failed, so there is no verdict.

    :param what: one sentence that says what happened and where
    :param fix: what the instructor can do about it
    """

    def __init__(self, what: str, fix: str = '') -> None:
        """Store both parts, so that a report can show them separately."""
        super().__init__(f'{what} {fix}'.strip())
        self.what = what
        self.fix = fix


class UsageError(GraderError):
    """Report that the arguments of a command or a simulation are wrong."""


def is_disk_full(error: BaseException) -> bool:
    """Return whether an error means that the disk is full."""
    return isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)


def from_os_error(error: OSError, where: str = 'the system') -> GraderError:
    """Convert an operating-system error, at its file or at ``where``, to a grader error."""
    where = where if error.filename is None else error.filename
    if is_disk_full(error):
        return GraderError(
            f'{where}: the disk is full.',
            'Try: free space on it, then run the same command again. Finished runs are kept.',
        )
    return GraderError(
        f'{where}: cannot be read or written: {str(error.strerror).lower()}.',
        'Try: check its permissions and the free space on the disk',
    )


def defect(error: Exception, where: str) -> GraderError:
    """Convert an unexpected exception in the grader to a grader error with a one-line message."""
    if isinstance(error, OSError) and is_disk_full(error):
        return from_os_error(error, where)
    return GraderError(
        f'{where}: the grader failed with {type(error).__name__}: {error}.',
        'Please report this with the submission.',
    )


def line_in(folder: Path, error: BaseException) -> str:
    """
    Return the file and line of the innermost traceback frame in a folder; empty if there is none.

    :param folder: such as the exams folder; the file is returned relative to its parent
    """
    places = [(frame.f_code.co_filename, line) for frame, line in walk_tb(error.__traceback__)]
    if isinstance(error, SyntaxError):
        places.append((error.filename or '', error.lineno or 0))
    inside = [(Path(file), line) for file, line in places if folder in Path(file).parents]
    if not inside:
        return ''
    file, line = inside[-1]
    return f'{file.relative_to(folder.parent).as_posix()}, line {line}'


class SandboxUnavailable(GraderError):
    """Report that no sandbox strong enough for hidden exams works on this machine."""


class ProbeFailed(GraderError):
    """Report that the probe failed, or that something outside the sandbox ended the program."""


class TooBusy(GraderError):
    """Report that the machine was too busy for a fair verdict."""


class RecordingInvalid(GraderError):
    """Report that a recording is unusable: it has a wrong version, or was truncated or changed."""


class ExamInvalid(GraderError):
    """Report that an exam is inconsistent: unknown dependency, no points, or duplicate name."""
