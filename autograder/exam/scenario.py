"""
Define scenarios: what the probe publishes and records, its steps, and the names in them, as data.

The steps are in :mod:`autograder.exam.steps`.  Advice for many exams contains placeholders such as
``$topic``.  The judge replaces them with the names of the exam that it judges, so advice never
shows the names of another exercise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
import re
from typing import Any

from autograder.exam.steps import Call, Endpoint, EVERYONE, Qos, Step

_TYPE = re.compile(r'^[a-z]\w*/(msg|srv)/[A-Z]\w*$')
_EXAMPLES = {'msg': 'std_msgs/msg/String', 'srv': 'rcl_interfaces/srv/GetParameters'}
_PLACEHOLDER = re.compile(r'\$(heard_topic|heard_type|topic|type|parameter)\b')


@dataclass(frozen=True)
class FeedTopic:
    """The type and QoS profile of a topic on which the probe publishes."""

    type: str
    qos: Qos = EVERYONE


@dataclass(frozen=True)
class RosClock:
    """
    A ``/clock`` for programs that run with ``use_sim_time``.

    Its start is far from system time, and its rate may differ from virtual time.  So each stamp
    and each period shows whether a program used the wrong clock.

    :param begins_s: first value [s]
    :param rate: ROS seconds per virtual second
    :param step_s: ROS time between two messages [s]; timers can only fire at these times
    """

    begins_s: float = 5_000.0
    rate: float = 1.0
    step_s: float = 0.25

    def at(self, clock_ns: int) -> int:
        """Return the ROS time in the last ``/clock`` message before a virtual time [ns]."""
        step_ns = round(self.step_s * 1e9)
        return round(self.begins_s * 1e9) + clock_ns // round(step_ns / self.rate) * step_ns

    def shows(self, ros_ns: int) -> bool:
        """Return whether a ``/clock`` message can contain this ROS time [ns]."""
        return (ros_ns - round(self.begins_s * 1e9)) % round(self.step_s * 1e9) == 0


@dataclass(frozen=True)
class Scenario:
    """
    The actions of the probe: inputs and times, never an expected value.

    :param program: what runs in the sandbox: ``'node'`` the node file; ``'build'`` a build of the
        student's package, followed by a node that sends back what it receives; ``'package'`` a
        build, followed by the package's executable with the file's name; ``'check'`` the file's
        function ``accepts(run)``, which gets each recorded run from the probe on ``/runs`` and
        whose answers are published on ``/answers``; ``''`` nothing, if all checks are static
    :param file: the file that ``program`` uses, such as ``node.py``
    :param arguments: the program's arguments after ``--ros-args``, such as ``('-r', '__ns:=/lab',
        '-p', 'threshold:=28.5')``; for ``'package'``, ``{share}`` is its share folder
    :param build_type: for ``'build'``, the message type that travels from ``/echo_in`` to
        ``/echo_out``, such as ``robot_msgs/msg/Speed``, which also names the package; for
        ``'package'``, the package's name
    :param watch: topics to record, full name to type such as ``'std_msgs/msg/String'``
    :param feed: topics on which the probe publishes, full name to type or :class:`FeedTopic`
    :param appear_s: timeout for the first node to appear [s]
    :param ros_clock: the ``/clock`` that the program follows, None for the computer's clock
    :param again: a second start of the program under different circumstances, such as a different
        namespace; checks with ``again=True`` judge it
    """

    program: str = 'node'
    file: str = ''
    arguments: Sequence[str] = ()
    build_type: str = ''
    watch: Mapping[str, str] = field(default_factory=dict)
    feed: Mapping[str, str | FeedTopic] = field(default_factory=dict)
    steps: Sequence[Step] = ()
    appear_s: float = 10.0
    ros_clock: RosClock | None = None
    again: Scenario | None = None

    def to_json(self) -> dict[str, Any]:
        """Return the scenario as the probe reads it, without the probe's node name."""
        feed = {topic: asdict(one) for topic, one in self.feeds.items()}
        parts = {'feed': feed, 'steps': [step.to_json() for step in self.steps]}
        found = {**asdict(replace(self, again=None)), **parts}
        # Without a second start, the digest of a scenario does not depend on this field.
        del found['again']
        return {**found, 'again': self.again.to_json()} if self.again else found

    @property
    def starts(self) -> tuple[Scenario, ...]:
        """Return the scenario of the first start, followed by that of a second one."""
        return (self, self.again) if self.again else (self,)

    @property
    def package_facts(self) -> Mapping[str, str]:
        """Return the names of the built package and its executable, empty if none is run."""
        if self.program != 'package':
            return {}
        return {'package': self.build_type, 'executable': self.file.removesuffix('.py')}

    @property
    def feeds(self) -> Mapping[str, FeedTopic]:
        """Return the topics on which the probe publishes, each with its type and QoS profile."""
        given = self.feed.items()
        return {topic: FeedTopic(one) if isinstance(one, str) else one for topic, one in given}

    def placed(self) -> Iterator[tuple[str, Step]]:
        """Yield each step with its position and name for error messages."""
        for number, step in enumerate(self.steps, 1):
            label = f' {getattr(step, step.label)!r}' if step.label else ''
            yield f'step {number} ({type(step).__name__}){label}', step

    def endpoints(self) -> Iterator[tuple[str, str, str]]:
        """
        Yield kind, full name and type of each endpoint that the program should have.

        Services with a full name in :class:`~autograder.exam.steps.Call` are among them; the other
        ones belong to every node.
        """
        yield from (('publisher', topic, name) for topic, name in self.watch.items())
        yield from (('subscription', topic, one.type) for topic, one in self.feeds.items())
        ends = (step for step in self.steps if isinstance(step, Endpoint))
        yield from ((end.asks, end.topic, end.type) for end in ends)
        calls = (step for step in self.steps if isinstance(step, Call) and '/' in step.service)
        yield from (('service', call.name, call.type) for call in calls)

    def types(self) -> Iterator[tuple[str, str, str]]:
        """Yield the place, topic (or an empty string) and name of each type the probe loads."""
        yield from ((f'watch {topic!r}', topic, name) for topic, name in self.watch.items())
        yield from ((f'feed {topic!r}', topic, one.type) for topic, one in self.feeds.items())
        for place, step in self.placed():
            if isinstance(step, (Call, Endpoint)):
                yield place, step.name if isinstance(step, Endpoint) else '', step.type

    def mistakes(self) -> Iterator[str]:
        """Yield the contradictions in the scenario, each with its place."""
        for place, topic, name in self.types():
            kind = 'msg' if topic else 'srv'
            if not _TYPE.match(name) or f'/{kind}/' not in name:
                yield f'{place}: expected a type such as {_EXAMPLES[kind]}, got {name!r}'
        for word, topics in (('watch', self.watch), ('feed', self.feed)):
            for topic in (one for one in topics if not one.startswith('/')):
                yield f'{word} {topic!r}: expected a full topic name, which begins with a slash'
        there = {
            'publisher': set[str](),
            'subscription': set(self.feed),
            'watch': set(self.watch),
        }
        for place, step in self.placed():
            yield from (f'{place}: {one}' for one in step.mistakes(there))
        if self.again:
            yield from (f'again, {one}' for one in self.again.mistakes())
            if self.again.again or self.again.file != self.file:
                yield f'again: expected one more start of {self.file!r}, and no third one'


@dataclass(frozen=True)
class Names:
    """
    The names that a scenario uses; if there are none, advice contains general words instead.

    :param published: topics that the probe records, full name to type
    :param heard: topics on which the probe publishes, full name to type
    :param services: services of the program that the probe calls, full name to type
    :param parameters: parameters that the scenario passes to the program, sets or reads
    """

    published: Mapping[str, str] = field(default_factory=dict)
    heard: Mapping[str, str] = field(default_factory=dict)
    services: Mapping[str, str] = field(default_factory=dict)
    parameters: tuple[str, ...] = ()

    @classmethod
    def of(cls, scenario: Scenario) -> Names:
        """Return the names of a scenario, in order of appearance."""
        found: dict[str, dict[str, str]] = {'publisher': {}, 'subscription': {}, 'service': {}}
        for kind, topic, name in (end for one in scenario.starts for end in one.endpoints()):
            found[kind].setdefault(topic, name)
        published, heard, services = found.values()
        parameters = (name for one in scenario.starts for name in _parameters(one))
        return cls(published, heard, services, tuple(dict.fromkeys(parameters)))

    def of_kind(self, kind: str) -> Mapping[str, str]:
        """Return the required publishers, subscriptions or services, full name to type."""
        by_kind = {'publisher': self.published, 'subscription': self.heard}
        return by_kind.get(kind, self.services)

    @cached_property
    def homes(self) -> Mapping[str, str]:
        """Return the exam's message and service classes, joined by spaces, by their module."""
        found: dict[str, list[str]] = {}
        for kind in {**self.heard, **self.published, **self.services}.values():
            package, part, name = kind.split('/')
            found.setdefault(f'{package}.{part}', []).append(name)
        return {module: ' '.join(names) for module, names in found.items()}

    def fill(self, text: str) -> str:
        """
        Replace the placeholders of a text with the names of the exam.

        :param text: may contain ``$topic`` and ``$type`` (what a node publishes), ``$heard_topic``
            and ``$heard_type`` (what it subscribes to), and ``$parameter``
        """
        return _PLACEHOLDER.sub(lambda found: self._words[found[1]], text)

    @cached_property
    def _words(self) -> Mapping[str, str]:
        topic, kind = next(iter({**self.published, **self.heard}.items()), ('topic', 'Type'))
        other, heard = next(iter({**self.heard, **self.published}.items()), ('topic', 'Type'))
        last = {'topic': topic, 'type': kind, 'heard_topic': other, 'heard_type': heard}
        # Leave out the namespace: in a hidden exam it is secret, and node code does not contain
        # it.
        words = {name: full.rpartition('/')[2] for name, full in last.items()}
        return {**words, 'parameter': next(iter(self.parameters), 'name')}


def _parameters(scenario: Scenario) -> Iterator[str]:
    for option, value in zip(scenario.arguments, scenario.arguments[1:], strict=False):
        if option == '-p':
            yield value.partition(':=')[0]
    for step in scenario.steps:
        if isinstance(step, Call):
            for one in step.request.get('parameters', ()):
                yield one['name']
            yield from step.request.get('names', ())
