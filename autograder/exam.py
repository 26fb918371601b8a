"""
How an exam is written: a scenario for the probe, and checks that judge the recording.

An exam module reads like the lesson it grades::

    exam = Exam('talker', assignment='03_topics', cells=('talker',), scenario=Scenario(...))

    @exam.check(points=2, needs=['publishes'])
    def one_message_a_second(run: Run) -> None:
        '''Your node publishes once per second.'''
        if len(run.recording.messages('/chatter')) != 60:
            raise Failed(expected='60 messages in 60 s', observed='...')

The docstring is the sentence the learner reads.  A check passes by returning, fails by raising
:class:`Failed`; any other exception is our own fault and flags the submission for a person.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
import hashlib
import inspect
import json
from typing import Any

from autograder.errors import ExamInvalid
from autograder.recording import Recording


@dataclass(frozen=True)
class Cause:
    """
    Why a check probably failed.

    :param cause_id: short stable name, for statistics and tests
    :param text: the reason in the learner's words
    :param try_this: the next thing to do
    """

    cause_id: str
    text: str
    try_this: str


class Failed(Exception):
    """
    A check fails, for a reason the learner can act on.

    :param expected: what the exercise asks for, with numbers and units
    :param observed: what was seen instead
    :param why: the likely cause; leave it out when unsure
    :param share: part of the check's points that is earned all the same, 0 to 1
    """

    def __init__(
        self, *, expected: str, observed: str, why: Cause | None = None, share: float = 0.0
    ) -> None:
        """Keep the facts apart; the report lays them out."""
        super().__init__(observed)
        self.expected = expected
        self.observed = observed
        self.why = why
        self.share = share


@dataclass(frozen=True)
class Run:
    """
    What a check may look at.

    :param files: the student's files, relative path to text
    :param recording: what the probe saw
    :param facts: the exam's own facts about its scenario, see :class:`Exam`
    """

    files: Mapping[str, str]
    recording: Recording
    facts: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Advance:
    """
    Move simulated time forward in equal steps.

    The step must be at most a quarter of the period that is examined: a timer that is stepped by
    whole periods fires once a step whatever its period.  ``phase_s`` puts the ticks off whole
    seconds, so that truncated or invented stamps show.

    :param seconds: simulated seconds
    :param step_s: length of one step [s]
    :param phase_s: the first clock value [s], below one period and below ``step_s``
    :param watch_s: wall seconds to watch code that does not follow the clock
    """

    seconds: float
    step_s: float = 0.25
    phase_s: float = 0.1
    watch_s: float = 3.0

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it, in whole nanoseconds."""
        return {
            'do': 'advance',
            'steps': round(self.seconds / self.step_s),
            'step_ns': round(self.step_s * 1e9),
            'first_ns': round(self.phase_s * 1e9),
            'watch_s': self.watch_s,
        }


@dataclass(frozen=True)
class Feed:
    """
    Send messages on a topic, one after the other or as one burst of at most ten.

    :param topic: full topic name, announced in :attr:`Scenario.feed`
    :param messages: fields of each message
    """

    topic: str
    messages: Sequence[Mapping[str, Any]]
    burst: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {
            'do': 'feed',
            'topic': self.topic,
            'messages': [dict(message) for message in self.messages],
            'burst': self.burst,
        }


@dataclass(frozen=True)
class Scenario:
    """
    What the probe does.  It holds inputs and never an expected value.

    :param program: what runs in the sandbox: ``'node'`` the node file, ``'build'`` a build of the
        student's package followed by a node that sends back what it receives
    :param file: the node file to run, for ``'node'``
    :param watch: topics to record, full name to type such as ``'std_msgs/msg/String'``
    :param feed: topics to send on, likewise
    :param appear_s: wall budget until the first node is seen [s]; discovery is usually 0.1 s and
        rarely 3 s
    :param first_log_s: wall budget for the first input's log line [s]
    """

    program: str = 'node'
    file: str = ''
    watch: Mapping[str, str] = field(default_factory=dict)
    feed: Mapping[str, str] = field(default_factory=dict)
    steps: Sequence[Advance | Feed] = ()
    appear_s: float = 10.0
    first_answer_s: float = 3.0
    answer_s: float = 5.0
    first_log_s: float = 3.0

    def to_json(self) -> dict[str, Any]:
        """Return the scenario as the probe reads it, without the probe's name."""
        return {**asdict(self), 'steps': [step.to_json() for step in self.steps]}


@dataclass(frozen=True)
class Check:
    """
    One line of the mark sheet.

    :param needs: names of checks that must have passed, else this one is NOT_RUN
    :param read: section of the lesson to read, empty for the exam's own
    :param static: whether the files alone can answer it, so that nothing is run for its sake
    """

    name: str
    title: str
    points: float
    judge: Callable[[Run], None]
    needs: tuple[str, ...] = ()
    read: str = ''
    static: bool = False


class Exam:
    """
    A scenario and its checks.

    :param name: unique in the course; the grade cell is ``check('<name>')``
    :param title: what it examines, for people
    :param assignment: folder of the lesson
    :param part: its place in the lesson, from 1
    :param cells: grade ids of the solution cells it judges
    :param requires: files without which nothing can be said
    :param scenario: what the probe does
    :param read: section of the lesson that explains the exercise
    :param facts: what the checks need to know about the scenario, kept out of the probe
    """

    def __init__(
        self,
        name: str,
        *,
        title: str,
        assignment: str,
        part: int,
        cells: Sequence[str],
        requires: Sequence[str],
        scenario: Scenario,
        read: str = '',
        facts: Mapping[str, Any] | None = None,
    ) -> None:
        """Start without checks; :meth:`check` adds them in order."""
        self.name = name
        self.title = title
        self.assignment = assignment
        self.part = part
        self.cells = tuple(cells)
        self.requires = tuple(requires)
        self.scenario = scenario
        self.read = read
        self.facts = dict(facts or {})
        self.checks: list[Check] = []

    def check(
        self, *, points: float, needs: Sequence[str] = (), read: str = '', static: bool = False
    ) -> Callable[[Callable[[Run], None]], Callable[[Run], None]]:
        """
        Add the decorated function as a check.

        :param points: > 0
        :param needs: names of earlier checks
        :param static: the files alone can answer it; if what must be run waits for checks that
            failed on the files, nothing is run
        :raises ExamInvalid: for a repeated name, no docstring, no points or an unknown need
        """

        def add(judge: Callable[[Run], None]) -> Callable[[Run], None]:
            name = judge.__name__
            self.add(Check(name, _title(judge), points, judge, tuple(needs), read, static))
            return judge

        return add

    def add(self, check: Check) -> None:
        """
        Add a check.

        :raises ExamInvalid: for a repeated name, no docstring, no points or an unknown need
        """
        names = [other.name for other in self.checks]
        where = f'exam {self.name}, check {check.name}'
        if check.name in names:
            raise ExamInvalid(f'{where}: the name is used twice.', 'Rename one of them.')
        if not check.title:
            raise ExamInvalid(f'{where}: no docstring.', 'Write the sentence learners will read.')
        if check.points <= 0:
            raise ExamInvalid(f'{where}: expected points > 0, got {check.points}.')
        for need in check.needs:
            if need not in names:
                raise ExamInvalid(
                    f'{where}: needs {need!r}, which is no earlier check.',
                    f'Earlier checks: {", ".join(names) or "none"}.',
                )
        self.checks.append(check)

    @property
    def max_points(self) -> float:
        """Return the points of all checks together."""
        return sum(check.points for check in self.checks)

    def scenario_digest(self) -> str:
        """Return a digest of all that the probe is told; equal digests give equal recordings."""
        text = json.dumps(self.scenario.to_json(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def _title(judge: Callable[[Run], None]) -> str:
    return ' '.join((inspect.getdoc(judge) or '').split())
