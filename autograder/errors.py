"""
The faults of the grader, as classes of exceptions.

::

    GraderError                  ours: the submission is flagged for a person, never scored
    |- SandboxUnavailable        no isolation that may run hidden exams; carries the fix
    |- ProbeFailed               the probe died or broke off: there is no evidence to judge
    |- TooBusy                   the machine gave a program too little of its time
    |- RecordingInvalid          a recording does not follow its format
    |- ExamInvalid               an exam contradicts itself
    `- UsageError                a command line names something that does not exist

A mistake in a *submission* is never an exception that leaves this package: it is a
:class:`~autograder.results.Problem` or a failed check.
"""

from __future__ import annotations

import errno
from pathlib import Path
from traceback import walk_tb


class GraderError(Exception):
    """
    The grader failed, so there is no verdict.

    :param what: one sentence, what happened and where
    :param fix: what the instructor can do about it
    """

    def __init__(self, what: str, fix: str = '') -> None:
        """Keep both parts, so that a report can show them separately."""
        super().__init__(f'{what} {fix}'.strip())
        self.what = what
        self.fix = fix


class UsageError(GraderError):
    """The command line names something that does not exist."""


def is_disk_full(error: BaseException) -> bool:
    """Return whether an error means that the disk is full."""
    return isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)


def of_system(error: OSError, where: str = 'the system') -> GraderError:
    """
    Return the error that explains a refusal of the operating system in one line.

    :param where: the place, if the system does not name one
    """
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
    """
    Return the error that explains a defect of the grader in one line.

    :param where: what was being done, such as the exam's name
    """
    if isinstance(error, OSError) and is_disk_full(error):
        return of_system(error, where)
    return GraderError(
        f'{where}: the grader failed with {type(error).__name__}: {error}.',
        'Please report this with the submission.',
    )


def line_in(folder: Path, error: BaseException) -> str:
    """
    Return file and line of the innermost frame in a folder, or an empty string.

    :param folder: such as that of the exams; files are named from its parent
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
    """No sandbox strong enough for hidden exams works on this machine."""


class ProbeFailed(GraderError):
    """The probe did not finish its work."""


class TooBusy(GraderError):
    """The machine was too busy for a fair verdict."""


class RecordingInvalid(GraderError):
    """A recording cannot be read: wrong version, cut off, or changed."""


class ExamInvalid(GraderError):
    """An exam contradicts itself: unknown dependency, no points, a name used twice."""
