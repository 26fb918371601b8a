"""
Whose fault it is, as a class.

::

    GraderError                  ours: the submission is flagged for a person, never scored
    |- SandboxUnavailable        no isolation that may run hidden exams; carries the fix
    |- ProbeFailed               the probe died or broke off: there is no evidence to judge
    |- TooBusy                   the machine gave a program too little of its time
    |- RecordingInvalid          a recording does not follow its format
    `- ExamInvalid               an exam contradicts itself

A mistake in a *submission* is never an exception that leaves this package: it is a
:class:`~autograder.judging.results.Problem` or a failed check.
"""

from __future__ import annotations


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


def defect(error: Exception, where: str) -> GraderError:
    """
    Return what is said of a defect of ours, which is for a person to look at.

    :param where: what was being done, such as the exam's name
    """
    return GraderError(
        f'{where}: the grader failed with {type(error).__name__}: {error}.',
        'Please report this with the submission.',
    )


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
