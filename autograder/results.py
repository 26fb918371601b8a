"""
The documents that the grader's stages exchange, as immutable data classes.

This module does not depend on ROS, Jupyter or nbgrader.  Everything converts to and from JSON
types.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from enum import Enum
from typing import Any


class Verdict(str, Enum):
    """The three outcomes of a check; a fault of the grader is an exception instead."""

    PASSED = 'PASSED'
    FAILED = 'FAILED'
    NOT_RUN = 'NOT_RUN'


def shortened(text: str, most: int = 60) -> str:
    """
    Return a text, or its beginning with an ellipsis if it is too long.

    :param most: length of what is returned [characters]
    """
    return text if len(text) <= most else f'{text[: most - 1]}\N{HORIZONTAL ELLIPSIS}'


def first_of(names: Sequence[str], most: int, between: str = ', ') -> str:
    """Return the first of some names, and how many more there are."""
    more = f' and {len(names) - most} more' if len(names) > most else ''
    return between.join(names[:most]) + more


@dataclass(frozen=True)
class Problem:
    """
    Bad input in one line: where, what was expected, what was found, what to try.

    :param where: file, cell or folder, as the reader knows it
    :param cells: the grade ids whose answers are missing because of it, empty if none
    :param unusable: whether nothing of the student's work could be read because of it
    """

    where: str
    expected: str
    got: str
    try_this: str
    cells: tuple[str, ...] = ()
    unusable: bool = False

    def line(self) -> str:
        """Return the problem as one line for people."""
        return f'{self.where}: expected {self.expected}, got {self.got}. Try: {self.try_this}.'

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Problem:
        """Rebuild a problem from :func:`dataclasses.asdict` output."""
        return cls(**{**data, 'cells': tuple(data.get('cells', ()))})


@dataclass(frozen=True)
class CheckResult:
    """
    The verdict of one check, with the five items that a learner reads if it fails.

    :param check: name of the check, unique in its exam
    :param title: the sentence that is checked, from the check's docstring
    :param points: points given, 0 <= points <= max_points
    :param expected: what the exercise asks for
    :param observed: what the probe saw
    :param cause: the likely reason, in words; empty when unknown
    :param cause_id: short stable name of the cause, for statistics and tests
    :param try_this: the next thing to do
    :param read: where to read about it
    :param waits_for: name of the check that has to pass first, for NOT_RUN
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
        """Return the items that are not empty, by name."""
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
        """Rebuild a result from :meth:`ExamResult.to_json` output."""
        return cls(**{**data, 'verdict': Verdict(data['verdict'])})


@dataclass(frozen=True)
class ExamResult:
    """
    All verdicts of one exam on one submission.

    :param exam: name of the exam
    :param checks: in the order of the exam
    :param note: one sentence about the run as a whole, empty if there is nothing to say
    :param mode: isolation mode the code ran in, see :mod:`autograder.sandboxes.isolation`
    :param not_protected: what that mode lacks, in words; empty for full isolation
    :param flags: what an instructor should look at, in words
    :param timing: wall-clock facts [s]; never part of a verdict.  ``run_s`` is the time of a run
        in this grading, ``kept_run_s`` the time of the earlier run whose recording was judged
    :param recording: name of the stored recording, empty if there is none
    :param pictures: by the name of a check, what its picture shows; JSON types, see
        :mod:`autograder.explaining.picture_data`; never part of a verdict
    """

    exam: str
    checks: tuple[CheckResult, ...]
    note: str = ''
    mode: str = ''
    flags: tuple[str, ...] = ()
    timing: Mapping[str, float] = field(default_factory=dict)
    recording: str = ''
    not_protected: tuple[str, ...] = ()
    pictures: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def points(self) -> float:
        """Return the sum of points given."""
        return sum(check.points for check in self.checks)

    @property
    def max_points(self) -> float:
        """Return the sum of the points that could be earned."""
        return sum(check.max_points for check in self.checks)

    @property
    def ran_s(self) -> float:
        """Return how long its run took, now or when it was recorded [s]; 0.0 if unknown."""
        return self.timing.get('run_s', self.timing.get('kept_run_s', 0.0))

    @property
    def failed(self) -> tuple[CheckResult, ...]:
        """Return the checks that failed, in order."""
        return tuple(check for check in self.checks if check.verdict is Verdict.FAILED)

    def to_json(self) -> dict[str, Any]:
        """Return JSON types only."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> ExamResult:
        """Rebuild a result from :meth:`to_json` output."""
        texts = {name: tuple(data.get(name, ())) for name in ('flags', 'not_protected')}
        checks = tuple(CheckResult.from_json(check) for check in data['checks'])
        return cls(**{**data, **texts, 'checks': checks})


@dataclass(frozen=True)
class SubmissionResult:
    """
    All results for one student's notebook.

    :param fault: a fault of the grader as text; then the submission is for review and has no grade
    :param noticed: what an instructor should look at in the notebook itself, as text
    """

    student: str
    assignment: str
    exams: tuple[ExamResult, ...] = ()
    problems: tuple[Problem, ...] = ()
    fault: str = ''
    noticed: tuple[str, ...] = ()

    @property
    def points(self) -> float:
        """Return the sum of points over the exams."""
        return sum(exam.points for exam in self.exams)

    @property
    def max_points(self) -> float:
        """Return the sum of points that the exams could give."""
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
        """Return what an instructor should look at, as text without repeats."""
        exams = (flag for exam in self.exams for flag in exam.flags)
        return tuple(dict.fromkeys((*self.noticed, *exams)))

    def to_json(self) -> dict[str, Any]:
        """Return JSON types only."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> SubmissionResult:
        """Rebuild a result from :meth:`to_json` output."""
        exams = tuple(ExamResult.from_json(exam) for exam in data['exams'])
        problems = tuple(Problem.from_json(problem) for problem in data['problems'])
        noticed = tuple(data.get('noticed', ()))
        return cls(**{**data, 'exams': exams, 'problems': problems, 'noticed': noticed})
