"""
Define the results of grading as immutable data classes, which the stages of the grader exchange.

This module does not depend on ROS, Jupyter or nbgrader.  Results and all objects in them can be
converted to and from JSON types.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from enum import Enum
from typing import Any


class Verdict(str, Enum):
    """The three outcomes of a check; a fault of the grader is an exception, not a verdict."""

    PASSED = 'PASSED'
    FAILED = 'FAILED'
    NOT_RUN = 'NOT_RUN'


def shortened(text: str, most: int = 60) -> str:
    """Return a string with an ellipsis if it is longer than ``most`` characters."""
    return text if len(text) <= most else f'{text[: most - 1]}\N{HORIZONTAL ELLIPSIS}'


def first_of(names: Sequence[str], most: int, between: str = ', ') -> str:
    """Return up to ``most`` names as one string, with the number of the remaining names."""
    more = f' and {len(names) - most} more' if len(names) > most else ''
    return between.join(names[:most]) + more


@dataclass(frozen=True)
class Problem:
    """
    A mistake in a submission: its place, what was expected, what was found, and what to try.

    :param where: name of the file, cell or folder, as shown to the reader
    :param cells: grade ids of the answers that are missing because of the problem
    :param unusable: whether the problem makes the whole submission unreadable
    """

    where: str
    expected: str
    got: str
    try_this: str
    cells: tuple[str, ...] = ()
    unusable: bool = False

    def line(self) -> str:
        """Return the problem as one line of text."""
        return f'{self.where}: expected {self.expected}, got {self.got}. Try: {self.try_this}.'

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Problem:
        """Create a problem from the output of :func:`dataclasses.asdict`."""
        return cls(**{**data, 'cells': tuple(data.get('cells', ()))})


@dataclass(frozen=True)
class CheckResult:
    """
    The verdict of one check, with the feedback for the student if it fails.

    :param check: name of the check, unique in its exam
    :param title: the statement that is checked, from the check's docstring
    :param points: awarded points, 0 <= points <= max_points
    :param expected: the behaviour that the exercise requires
    :param observed: the behaviour that the probe recorded
    :param cause: the likely cause as text; empty if unknown
    :param cause_id: short stable name of the cause, for statistics and tests
    :param waits_for: name of the check that must pass first, if the verdict is NOT_RUN
    """

    check: str
    title: str
    verdict: Verdict
    points: float
    max_points: float
    expected: str = ''
    observed: str = ''
    cause: str = ''
    cause_id: str = ''
    try_this: str = ''
    read: str = ''
    waits_for: str = ''

    @property
    def facts(self) -> dict[str, str]:
        """Return the parts of the feedback that are not empty, by name."""
        facts = {
            'expected': self.expected,
            'observed': self.observed,
            'likely cause': self.cause,
            'try': self.try_this,
            'read': self.read,
        }
        return {name: text for name, text in facts.items() if text}

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> CheckResult:
        """Create a result from one check in the output of :meth:`ExamResult.to_json`."""
        return cls(**{**data, 'verdict': Verdict(data['verdict'])})


@dataclass(frozen=True)
class ExamResult:
    """
    All verdicts of one exam on one submission; neither timing nor pictures are compared.

    :param checks: in the order of the exam
    :param note: one sentence about the whole run; may be empty
    :param mode: isolation mode of the run, see :mod:`autograder.sandboxes.isolation`
    :param not_protected: what that mode does not protect, as text; empty for full isolation
    :param flags: observations that an instructor should look at, as text
    :param timing: wall-clock times [s], which do not affect verdicts.  ``run_s`` is the duration
        of a run in this grading, ``kept_run_s`` that of the run in a stored recording
    :param recording: file name of the stored recording, empty if there is none
    :param pictures: data of pictures by the name of the check, as JSON types, see
        :mod:`autograder.explaining.picture_data`; they do not affect verdicts
    """

    exam: str
    checks: tuple[CheckResult, ...]
    note: str = ''
    mode: str = ''
    flags: tuple[str, ...] = ()
    timing: Mapping[str, float] = field(default_factory=dict, compare=False)
    recording: str = ''
    not_protected: tuple[str, ...] = ()
    pictures: Mapping[str, Mapping[str, Any]] = field(default_factory=dict, compare=False)

    @property
    def points(self) -> float:
        """Return the sum of the awarded points."""
        return sum(check.points for check in self.checks)

    @property
    def max_points(self) -> float:
        """Return the sum of the maximum points of all checks."""
        return sum(check.max_points for check in self.checks)

    @property
    def ran_s(self) -> float:
        """Return the duration of the run [s], measured now or stored; 0.0 if unknown."""
        return self.timing.get('run_s', self.timing.get('kept_run_s', 0.0))

    @property
    def failed(self) -> tuple[CheckResult, ...]:
        """Return the checks that failed, in order."""
        return tuple(check for check in self.checks if check.verdict is Verdict.FAILED)

    def to_json(self) -> dict[str, Any]:
        """Convert the result to JSON types."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> ExamResult:
        """Create a result from the output of :meth:`to_json`."""
        texts = {name: tuple(data.get(name, ())) for name in ('flags', 'not_protected')}
        checks = tuple(CheckResult.from_json(check) for check in data['checks'])
        return cls(**{**data, **texts, 'checks': checks})


@dataclass(frozen=True)
class SubmissionResult:
    """
    All results of one submission.

    :param fault: a fault of the grader as text; if not empty, the submission is for review
    :param noticed: observations about the notebook that an instructor should look at, as text
    :param collected: digest of the student's collected work when it was graded; empty if there was
        none, None if it is not known
    """

    student: str
    assignment: str
    exams: tuple[ExamResult, ...] = ()
    problems: tuple[Problem, ...] = ()
    fault: str = ''
    noticed: tuple[str, ...] = ()
    collected: str | None = None

    @property
    def points(self) -> float:
        """Return the sum of the awarded points of all exams."""
        return sum(exam.points for exam in self.exams)

    @property
    def max_points(self) -> float:
        """Return the sum of the maximum points of all exams."""
        return sum(exam.max_points for exam in self.exams)

    @property
    def unusable(self) -> str:
        """Return why the grader could not read any of the student's work; empty if it could."""
        return next((one.line() for one in self.problems if one.unusable), '')

    @property
    def review(self) -> str:
        """Return why there is no score and a person has to decide; empty if there is a score."""
        return self.fault or self.unusable

    @property
    def flags(self) -> tuple[str, ...]:
        """Return the distinct observations that an instructor should look at, as text."""
        exams = (flag for exam in self.exams for flag in exam.flags)
        return tuple(dict.fromkeys((*self.noticed, *exams)))

    def to_json(self) -> dict[str, Any]:
        """Convert the result to JSON types."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> SubmissionResult:
        """Create a result from the output of :meth:`to_json`."""
        exams = tuple(ExamResult.from_json(exam) for exam in data['exams'])
        problems = tuple(Problem.from_json(problem) for problem in data['problems'])
        noticed = tuple(data.get('noticed', ()))
        return cls(**{**data, 'exams': exams, 'problems': problems, 'noticed': noticed})
