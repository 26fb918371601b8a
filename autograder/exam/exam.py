"""
Define exams: a scenario for the probe, and checks that judge the recording.

The steps of a scenario are in :mod:`autograder.exam.steps`.  Helpers for checks are in
:mod:`autograder.judging.checks`; ``docs/writing-an-exam.md`` shows an example.

Learners read the docstring of a check.  A check passes by returning and fails by raising
:class:`Failed`.  Any other exception is a fault of the grader: the submission is marked
*for review*.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, KW_ONLY, replace
import hashlib
import inspect
import json
from typing import Any

from autograder.errors import ExamInvalid
from autograder.exam.scenario import Names, Scenario
from autograder.exam.specification import Cause, Specification
from autograder.exam.steps import Advance, Feed
from autograder.recording import Event, Recording

__all__ = ['Advance', 'Cause', 'Check', 'Exam', 'Failed', 'Feed', 'Run', 'Scenario']


@dataclass(eq=False, kw_only=True)
class Failed(Exception):
    """
    Report that a check failed, with a reason on which the learner can act.

    :param expected: what the exercise requires, with numbers and units
    :param observed: what the program did instead
    :param why: the likely cause, None if it is uncertain
    :param share: fraction of the check's points that the learner still gets, 0 to 1
    :param blocks: whether the checks that need this one are then NOT_RUN
    :param at: virtual time of the first deviation [ns], if no single event shows it
    :param place: index of the first input with a wrong answer, only used to draw the picture
    :param every_s: period of the expected messages [s], only used to draw the picture
    :param shown_by: log lines that show the failure; their place in the code helps to explain it
    :param act: the act that this check judges, see :mod:`autograder.submission.code.acts`; it
        locates a slip that has no row in ``judging/causes/places.txt``
    """

    expected: str
    observed: str
    why: Cause | None = None
    share: float = 0.0
    blocks: bool = True
    at: int | None = None
    place: int | None = None
    every_s: float | None = None
    shown_by: Sequence[Event] = ()
    act: str = ''

    def __str__(self) -> str:
        return self.observed


@dataclass(frozen=True)
class Run:
    """
    The input of a check.

    :param files: the student's files, relative path to text
    :param facts: other data that the checks need, see :class:`Exam`
    """

    files: Mapping[str, str]
    recording: Recording
    facts: Mapping[str, Any] = field(default_factory=dict)

    @property
    def secret(self) -> bool:
        """Return whether the inputs are secret, so that feedback must not show them."""
        return bool(self.facts.get('secret'))

    def asked(self, ask: str) -> Specification:
        """Return one of the exam's specifications by its name in :attr:`Exam.asks`."""
        found: Specification = self.facts[ask]
        return found

    def during(self, phase: str) -> Run:
        """
        Return one phase of the run, with the graphs of all phases.

        Checks need these graphs to recognise the log lines of the student's nodes.
        """
        return self._only(self.recording.phase(phase))

    def parts(self, phase: str) -> list[tuple[Run, float]]:
        """Return each part of the run in a phase as :meth:`during`, with its duration [s]."""
        return [(self._only(one), seconds) for one, seconds in self.recording.parts(phase)]

    def _only(self, part: Recording) -> Run:
        graphs = self.recording.of('graph')
        return replace(self, recording=Recording(part.header, (*graphs, *part.events)))

    def again(self) -> Run:
        """Return the run of the program's second start."""
        second = self.recording.again or Recording(self.recording.header, ())
        return replace(self, recording=second)

    @property
    def names(self) -> Names:
        """Return the topics, types and parameters that the exam uses."""
        names: Names = self.facts.get('exam_names', Names())
        return names


@dataclass(frozen=True)
class Check:
    """
    One check, a line of the mark sheet.

    :param needs: names of checks that must have passed; otherwise this check is NOT_RUN
    :param read: section of the lesson to read, empty for the section of the exam
    :param static: whether the check looks only at the files, so that it needs no run
    :param again: whether the check judges the second start of the program
    """

    name: str
    title: str
    points: float
    judge: Callable[[Run], None]
    needs: tuple[str, ...] = ()
    read: str = ''
    static: bool = False
    again: bool = False

    def run_of(self, run: Run) -> Run:
        """Return the part of a run that the check judges: the first or the second start."""
        return run.again() if self.again else run


@dataclass(eq=False)
class Exam:
    """
    A scenario and its checks.

    :param name: unique in the course; the grade cell is ``check('<name>')``
    :param assignment: folder of the lesson
    :param part: position of the exam in the lesson, from 1
    :param cells: grade ids of the answer cells to judge, by default one with the exam's name
    :param requires: files that the exam needs, by default the file that the scenario runs
    :param read: section of the lesson that explains the exercise
    :param facts: data for the checks that the probe does not get
    :param asks: specifications by name
    """

    name: str
    _: KW_ONLY
    title: str
    assignment: str
    part: int
    scenario: Scenario
    cells: Sequence[str] = ()
    requires: Sequence[str] = ()
    read: str = ''
    facts: dict[str, Any] = field(default_factory=dict)
    asks: Mapping[str, Specification] = field(default_factory=dict)
    hidden: bool = field(default=False, init=False)  # catalog.load() sets it for hidden exams
    checks: list[Check] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        """Fill in default values; a mistake in the scenario raises :class:`ExamInvalid`."""
        for mistake in self.scenario.mistakes():
            raise ExamInvalid(f'exam {self.name}, {mistake}.', 'Steps are described in steps.py.')
        file = self.scenario.file
        self.cells = tuple(self.cells) or (self.name,)
        self.requires = tuple(self.requires) or ((file,) if file else ())
        given = {**self.scenario.package_facts, **self.facts, **self.asks}
        self.facts = {'exam_names': Names.of(self.scenario), **given}

    def scenario_of(self, check: Check) -> Scenario:
        """Return the scenario of the start that a check judges."""
        return self.scenario.starts[check.again]

    def check(
        self,
        *,
        points: float,
        needs: Sequence[str] = (),
        read: str = '',
        static: bool = False,
        again: bool = False,
    ) -> Callable[[Callable[[Run], None]], Callable[[Run], None]]:
        """
        Add the decorated function as a check.

        :param points: > 0
        :param needs: names of earlier checks
        :param static: whether the check looks only at the files; if failed static checks block all
            other checks, the grader does not run the program
        :param again: whether the check judges the second start, :attr:`Scenario.again`
        :raises ExamInvalid: if a name is repeated, a docstring is missing, the points are not
            above 0, a need is not an earlier check, the check needs a program, or a second start,
            and the scenario has none, or the exam lacks what a claim needs
        """

        def add(judge: Callable[[Run], None]) -> Callable[[Run], None]:
            name = judge.__name__
            title = ' '.join((inspect.getdoc(judge) or '').split())
            self._add(Check(name, title, points, judge, tuple(needs), read, static, again))
            return judge

        return add

    def _add(self, check: Check) -> None:
        names = [other.name for other in self.checks]
        where = f'exam {self.name}, check {check.name}'
        if check.name in names:
            raise ExamInvalid(f'{where}: the name is used twice.', 'Rename one of the checks.')
        if not check.title:
            raise ExamInvalid(f'{where}: no docstring.', 'Write the sentence learners will read.')
        if check.points <= 0:
            raise ExamInvalid(f'{where}: expected points > 0, got {check.points}.')
        if not (check.static or self.scenario.program):
            raise ExamInvalid(
                f'{where}: the scenario runs no program, so the check can use only files.',
                'Add the check with static=True, or give the scenario a program.',
            )
        if check.again and (check.static or not self.scenario.again):
            raise ExamInvalid(f'{where}: judges a second start, but there is none.')
        for test in getattr(check.judge, 'tests', ()):
            for mistake in test(self, self.scenario_of(check)):
                raise ExamInvalid(f'{where}: {mistake}.')
        for need in check.needs:
            if need not in names:
                raise ExamInvalid(
                    f'{where}: needs {need!r}, which is not an earlier check.',
                    f'Earlier checks: {", ".join(names) or "none"}.',
                )
        self.checks.append(check)

    @property
    def max_points(self) -> float:
        """Return the sum of the points of all checks."""
        return sum(check.points for check in self.checks)

    def scenario_digest(self) -> str:
        """Return a digest of the scenario, which identifies the scenario in recordings."""
        text = json.dumps(self.scenario.to_json(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:32]
