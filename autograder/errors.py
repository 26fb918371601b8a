"""
Whose fault it is, as a class.

::

    GraderError                  ours: the submission is flagged for a person, never scored
    |- SandboxUnavailable        no isolation that may run hidden exams; carries the fix
    |- ProbeFailed               the probe died or broke off: there is no evidence to judge
    |- TooBusy                   the machine gave a program too little of its time
    |- RecordingInvalid          a recording does not follow its format
    |- ExamInvalid               an exam contradicts itself
    `- UsageError                a command line asks for something that is not there

A mistake in a *submission* is never an exception that leaves this package: it is a
:class:`~autograder.results.Problem` or a failed check.
"""

from __future__ import annotations

import errno
from pathlib import Path
from traceback import walk_tb


class GraderError(Exception):
    """
    Something on our side went wrong, so there is no verdict.

    :param what: one sentence, what happened and where
    :param fix: what the instructor can do about it
    """

    def __init__(self, what: str, fix: str = '') -> None:
        """Keep both halves, so that a report can lay them out."""
        super().__init__(f'{what} {fix}'.strip())
        self.what = what
        self.fix = fix


class UsageError(GraderError):
    """The command line asks for something that is not there."""


def is_disk_full(error: BaseException) -> bool:
    """Return whether there was no room for a file, which is not a defect of anything."""
    return isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT)


def of_system(error: OSError, where: str = 'the system') -> GraderError:
    """
    Return one line about what the system refused.

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
    Return what is said of a defect of ours, which is for a person to look at.

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
    Return file and line of the innermost code of a folder that raised an error, or nothing.

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
    """The probe, our observer inside the sandbox's network, did not finish its work."""


class TooBusy(GraderError):
    """The machine had so little time for a program that no verdict would be fair."""


class RecordingInvalid(GraderError):
    """A recording cannot be read: wrong version, truncated, or not ours."""


class ExamInvalid(GraderError):
    """An exam contradicts itself: unknown dependency, no points, a name used twice."""
