"""
Define scenarios: the steps that the probe executes in order, as data.

Steps contain inputs, but never an expected value.  Most exams need only ``Advance`` and ``Feed``.
``Call`` calls a service of the student's node; ``Offer`` and ``Join`` add a publisher or a
subscription of the probe, ``Leave`` removes one, and ``Watch`` records a topic again; ``Mark``
begins a phase that checks can select; ``Look`` records the graph.

All seconds are virtual and exact; 60 virtual seconds take about 0.1 s of real time.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from difflib import get_close_matches
import math
import re
from typing import Any, ClassVar

MAX_BURST = 10
SETTLE_S = 0.2  # duration of a step that adds or removes an endpoint, see probe_run.py [s]
TRANSITIONS = {'configure': 1, 'cleanup': 2, 'activate': 3, 'deactivate': 4}
PARAMETER_TYPES = {
    bool: (1, 'bool'),
    int: (2, 'integer'),
    float: (3, 'double'),
    str: (4, 'string'),
}
_TYPE = re.compile(r'^[a-z]\w*/(msg|srv)/[A-Z]\w*$')
_EXAMPLES = {'msg': 'std_msgs/msg/String', 'srv': 'rcl_interfaces/srv/GetParameters'}


@dataclass(frozen=True)
class Qos:
    """
    A QoS profile, as discovery announces it.

    :param depth: 0 keeps all messages
    :param deadline_s: None means infinite, here and for the other durations [s]
    """

    reliability: str = 'RELIABLE'
    durability: str = 'VOLATILE'
    depth: int = 10
    deadline_s: float | None = None
    lifespan_s: float | None = None
    liveliness: str = 'AUTOMATIC'
    lease_s: float | None = None


EVERYONE = Qos(durability='TRANSIENT_LOCAL')
"""The publisher profile that is compatible with every reliability and durability."""


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
        """
        Return the ROS time in the last ``/clock`` message before a moment [ns].

        :param clock_ns: virtual time since the program was released [ns]
        """
        step_ns = round(self.step_s * 1e9)
        return round(self.begins_s * 1e9) + clock_ns // round(step_ns / self.rate) * step_ns

    def shows(self, ros_ns: int) -> bool:
        """Return whether a ``/clock`` message can contain this ROS time [ns]."""
        return (ros_ns - round(self.begins_s * 1e9)) % round(self.step_s * 1e9) == 0


There = Mapping[str, set[str]]
"""
Names of the probe's endpoints, by the kind of the matching endpoint in the program.

A subscription of the probe is under ``publisher``, a publisher under ``subscription``; ``watch``
has the recorded topics.
"""


def _json_of(value: Any) -> Any:
    """Return a value with strings for NaN and infinity, which JSON does not have."""
    if isinstance(value, dict):
        return {name: _json_of(one) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_json_of(one) for one in value]
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


@dataclass(frozen=True)
class Step:
    """
    One step of the probe, with an interface that is the same for all steps.

    A new kind of step is a subclass here, and a function with its lower-case name in
    ``probe/probe_steps.py``.
    """

    label: ClassVar[str] = ''
    """Attribute that identifies the step in error messages, empty for none."""

    def to_json(self) -> dict[str, Any]:
        """Return the step in the format that the probe reads."""
        return {'do': type(self).__name__.lower(), **_json_of(asdict(self))}

    def mistakes(self, there: There) -> Iterator[str]:
        """
        Yield contradictions with earlier steps, and update the set of endpoints.

        :param there: endpoints that exist before this step
        """
        yield from ()

    def sends(self) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        """Yield each message or request: its position in the step, type or topic, and fields."""
        yield from ()


@dataclass(frozen=True)
class Advance(Step):
    """Let time pass while the probe records."""

    seconds: float

    def mistakes(self, there: There) -> Iterator[str]:
        """Yield a message if the duration is not positive."""
        if not self.seconds > 0:
            yield f'the number of seconds must be above 0, got {self.seconds}'


@dataclass(frozen=True)
class Feed(Step):
    """
    Publish messages at a fixed interval or as one burst, then wait.

    :param topic: full topic name in :attr:`Scenario.feed`, or the name of an :class:`Offer`
    :param messages: fields of each message
    :param optional: whether to skip this step if no subscription is connected; otherwise the run
        ends
    :param every_s: time from one message to the next [s]
    :param rest_s: additional time after the last message [s]
    """

    topic: str
    messages: Sequence[Mapping[str, Any]]
    burst: bool = False
    optional: bool = False
    every_s: float = 1.0
    rest_s: float = 2.0

    def mistakes(self, there: There) -> Iterator[str]:
        """Yield a message for a topic that was not announced, and for a burst that is too long."""
        if self.topic not in there['subscription']:
            yield _not_announced(self.topic, there['subscription'])
        if self.burst and len(self.messages) > MAX_BURST:
            yield f'expected at most {MAX_BURST} messages per burst, got {len(self.messages)}'

    def sends(self) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        """Yield the messages."""
        for which, message in enumerate(self.messages, 1):
            yield f': message {which}', self.topic, message


def feeds(topic: str, messages: Sequence[Mapping[str, Any]], burst: int, **how: Any) -> list[Feed]:
    """
    Return the steps that send some messages one by one and the last ones as a burst.

    :param burst: number of messages in the burst, 0 for none
    :param how: other fields of :class:`Feed`
    """
    singles = len(messages) - burst
    last = [Feed(topic, messages[singles:], burst=True, **how)] if burst else []
    return [Feed(topic, messages[:singles], **how), *last]


@dataclass(frozen=True)
class Call(Step):
    """
    Call a service of the student's node once, and record ``answer`` or ``no_answer``.

    :param node: full node name
    :param service: last part of the name, such as ``set_parameters``, or a full name with a slash
    :param type: such as ``rcl_interfaces/srv/SetParameters``
    :param request: fields of the request
    :param patience_s: timeout for the response [s]
    """

    node: str
    service: str
    type: str
    request: Mapping[str, Any] = field(default_factory=dict)
    patience_s: float = 5.0
    label = 'service'

    @property
    def name(self) -> str:
        """Return the service's full name."""
        return self.service if self.service.startswith('/') else f'{self.node}/{self.service}'

    def to_json(self) -> dict[str, Any]:
        """Return the step in the format that the probe reads, with the service's full name."""
        step = {**super().to_json(), 'service': self.name}
        del step['node']
        return step

    def sends(self) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        """Yield the request."""
        yield '', self.type, self.request


@dataclass(frozen=True)
class Endpoint(Step):
    """
    Add a publisher or a subscription of the probe.

    :param name: identifies the endpoint in later steps and in the recording; no slash
    :param topic: full topic name
    """

    name: str
    topic: str
    type: str
    label = 'name'
    asks: ClassVar[str] = ''
    """The matching endpoint of the program: ``'publisher'`` or ``'subscription'``."""

    def mistakes(self, there: There) -> Iterator[str]:
        """Announce the name; a new endpoint contradicts no earlier step."""
        there[self.asks].add(self.name)
        yield from ()


@dataclass(frozen=True)
class Join(Endpoint):
    """
    Add a subscription of the probe.

    Its messages are recorded with ``listener``; a ``joined`` event records whether the
    subscription matched.

    :param listen_s: how long to listen before the next step [s]
    """

    qos: Qos = Qos()
    listen_s: float = 0.4
    asks = 'publisher'


@dataclass(frozen=True)
class Offer(Endpoint):
    """Add a publisher of the probe, which ``Feed(name, ...)`` uses."""

    qos: Qos = EVERYONE
    asks = 'subscription'


@dataclass(frozen=True)
class Leave(Step):
    """
    Remove an endpoint of the probe.

    If only a :class:`Mark` precedes this step, a recorded topic has no subscription from the
    start.

    :param name: of a :class:`Join` or an :class:`Offer`, or a topic of :attr:`Scenario.feed` or
        :attr:`Scenario.watch`
    """

    name: str

    def mistakes(self, there: There) -> Iterator[str]:
        """Reject a name that was not announced; otherwise remove it."""
        announced = there['publisher'] | there['subscription'] | there['watch']
        if self.name not in announced:
            yield _not_announced(self.name, announced)
        for asks in ('publisher', 'subscription'):
            there[asks].discard(self.name)


@dataclass(frozen=True)
class Watch(Step):
    """
    Subscribe again to a recorded topic after a :class:`Leave`.

    :param topic: full topic name in :attr:`Scenario.watch`
    """

    topic: str
    label = 'topic'

    def mistakes(self, there: There) -> Iterator[str]:
        """Reject a topic that is not recorded."""
        if self.topic not in there['watch']:
            yield f'expected a topic of Scenario(watch=...), got {self.topic!r}'


def unheard(topic: str, seconds: float) -> tuple[Step, ...]:
    """
    Return the steps in which time passes without a subscription on a recorded topic.

    See :func:`autograder.judging.rhythm.with_unheard` for the messages of this time.
    """
    return (Leave(topic), Advance(seconds - SETTLE_S), Watch(topic))


@dataclass(frozen=True)
class Mark(Step):
    """
    Begin a phase of the run, see :meth:`autograder.recording.Recording.phase`.

    :param name: the name by which checks select the phase
    """

    name: str


@dataclass(frozen=True)
class Look(Step):
    """
    Record the current graph, in addition to the graphs at the start and at the end.

    :param when: label for checks: ``recording.of('graph', when=...)``
    """

    when: str


def _not_announced(name: str, there: set[str]) -> str:
    close = get_close_matches(name, there, n=1, cutoff=0.6)
    hint = f'; did you mean {close[0]!r}?' if close else ''
    known = ', '.join(sorted(map(repr, there))) or 'nothing'
    return (
        f'{name!r} was not announced by Scenario(feed=...), an Offer or a Join; '
        f'announced: {known}{hint}'
    )


Value = bool | int | float | str
"""The value of a parameter."""


def set_parameters(node: str, values: Mapping[str, Value], atomically: bool = False) -> Call:
    """
    Return the call that sets parameters of a node.

    :param atomically: whether the node is to set either all of them or none
    """
    wanted = []
    for name, value in values.items():
        number, word = PARAMETER_TYPES[type(value)]
        wanted.append({'name': name, 'value': {'type': number, f'{word}_value': value}})
    service = 'set_parameters_atomically' if atomically else 'set_parameters'
    kind = f'rcl_interfaces/srv/SetParameters{"Atomically" if atomically else ""}'
    return Call(node, service, kind, {'parameters': wanted})


def transition(node: str, name: str) -> Call:
    """
    Return the call that requests a transition from a lifecycle node.

    :param name: ``configure``, ``activate``, ``deactivate`` or ``cleanup``
    """
    wanted = {'transition': {'id': TRANSITIONS[name]}}
    return Call(node, 'change_state', 'lifecycle_msgs/srv/ChangeState', wanted)


def state(node: str) -> Call:
    """Return the call that requests the state of a lifecycle node."""
    return Call(node, 'get_state', 'lifecycle_msgs/srv/GetState')


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

    def to_json(self) -> dict[str, Any]:
        """Return the scenario as the probe reads it, without the probe's node name."""
        feed = {topic: asdict(one) for topic, one in self.feeds.items()}
        return {**asdict(self), 'feed': feed, 'steps': [step.to_json() for step in self.steps]}

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
        """Yield kind, full topic name and type of each endpoint that the program should have."""
        yield from (('publisher', topic, name) for topic, name in self.watch.items())
        yield from (('subscription', topic, one.type) for topic, one in self.feeds.items())
        ends = (step for step in self.steps if isinstance(step, Endpoint))
        yield from ((end.asks, end.topic, end.type) for end in ends)

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
