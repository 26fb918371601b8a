"""
What the probe does, as data: the steps of a scenario, in order, in virtual time.

Steps hold inputs and never an expected value.  ``Advance`` and ``Feed`` are most of what an exam
needs; ``Call`` asks a service of the student's node; ``Offer``, ``Join`` and ``Leave`` let a
publisher or a subscription of ours come and go; ``Mark`` begins a phase, so that a check can ask
what happened in it; ``Look`` writes down the graph.

All seconds are virtual: sixty of them take a tenth of a real one, and are exact.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from difflib import get_close_matches
import math
import re
from typing import Any, ClassVar

MAX_BURST = 10
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
    A quality of service, as the wire has it.

    :param depth: 0 keeps all
    :param deadline_s: None is infinite, as are the others
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
    """A topic to send on, with a quality of service of its own."""

    type: str
    qos: Qos = EVERYONE


@dataclass(frozen=True)
class RosClock:
    """
    A ``/clock`` for a program with ``use_sim_time``: for exams about the ROS clock alone.

    It begins far from system time and runs at another rate, so the wrong clock shows in each stamp
    and each period.

    :param begins_s: first value [s]
    :param rate: ROS seconds per virtual second
    :param step_s: ROS time between two messages [s]; timers fire at such a step
    """

    begins_s: float = 5_000.0
    rate: float = 1.0
    step_s: float = 0.25

    def at(self, clock_ns: int) -> int:
        """
        Return the ROS time that the last message before a moment has told [ns].

        :param clock_ns: virtual time since the program was let go [ns]
        """
        step_ns = round(self.step_s * 1e9)
        return round(self.begins_s * 1e9) + clock_ns // round(step_ns / self.rate) * step_ns

    def shows(self, ros_ns: int) -> bool:
        """Return whether it ever tells a ROS time [ns]."""
        return (ros_ns - round(self.begins_s * 1e9)) % round(self.step_s * 1e9) == 0


There = Mapping[str, set[str]]
"""Names of the grader's current publishers and subscriptions, by what the program has for them."""


@dataclass(frozen=True)
class Step:
    """
    What the probe does next, and what others ask of a step without knowing its kind.

    A new kind is a subclass here, and a function of its name in ``probe/probe_steps.py``.
    """

    label: ClassVar[str] = ''
    """Attribute that tells the step from others of its kind, empty without one."""

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {'do': type(self).__name__.lower(), **asdict(self)}

    def mistakes(self, there: There) -> Iterator[str]:
        """
        Yield what contradicts the earlier steps, and change what is there.

        :param there: as the earlier steps have left it
        """
        yield from ()

    def sends(self) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        """Yield what it sends: the place in the step, its type or publisher, the fields."""
        yield from ()


@dataclass(frozen=True)
class Advance(Step):
    """
    Let time pass, and listen.

    :param seconds: how long [s]
    """

    seconds: float

    def mistakes(self, there: There) -> Iterator[str]:
        """Refuse a step in which no time passes."""
        if not self.seconds > 0:
            yield f'the number of seconds must be above 0, got {self.seconds}'


@dataclass(frozen=True)
class Feed(Step):
    """
    Send messages on a topic, one a second or as one burst, and listen some seconds after the last.

    :param topic: full topic name, announced in :attr:`Scenario.feed`, or the name of an
        :class:`Offer`
    :param messages: fields of each message
    :param optional: nobody needs to be connected; else the run ends where nobody is
    :param every_s: time from one message to the next [s]
    :param rest_s: time after the last one, besides that [s]
    """

    topic: str
    messages: Sequence[Mapping[str, Any]]
    burst: bool = False
    optional: bool = False
    every_s: float = 1.0
    rest_s: float = 2.0

    def mistakes(self, there: There) -> Iterator[str]:
        """Refuse a topic that nobody announced, and a burst that is too long."""
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
    Return the steps that send messages one by one, and the last of them at once.

    :param burst: how many come at once; 0 for none
    :param how: further fields of :class:`Feed`
    """
    singles = len(messages) - burst
    last = [Feed(topic, messages[singles:], burst=True, **how)] if burst else []
    return [Feed(topic, messages[:singles], **how), *last]


@dataclass(frozen=True)
class Call(Step):
    """
    Call a service of the student's node, once; recorded as ``answer`` or ``no_answer``.

    :param node: full node name
    :param service: its last part, such as ``set_parameters``, or a full name with a slash
    :param type: such as ``rcl_interfaces/srv/SetParameters``
    :param request: fields of the request
    :param patience_s: how long an answer may take [s]
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
        """Return the step as the probe reads it, with the service's full name."""
        told = {**super().to_json(), 'service': self.name}
        del told['node']
        return told

    def sends(self) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        """Yield the request."""
        yield '', self.type, self.request


@dataclass(frozen=True)
class Endpoint(Step):
    """
    A publisher or a subscription of ours that comes at this moment.

    :param name: without a slash
    :param topic: full topic name
    """

    name: str
    topic: str
    type: str
    label = 'name'
    asks: ClassVar[str] = ''
    """What the program should have: ``'publisher'`` or ``'subscription'``."""

    def mistakes(self, there: There) -> Iterator[str]:
        """Announce the name."""
        there[self.asks].add(self.name)
        yield from ()


@dataclass(frozen=True)
class Join(Endpoint):
    """
    Join a topic with a subscription of our own, at this moment.

    What it hears is recorded with ``listener``, and ``joined`` tells whether it was matched.

    :param listen_s: how long to listen before the next step [s]
    """

    qos: Qos = Qos()
    listen_s: float = 0.4
    asks = 'publisher'


@dataclass(frozen=True)
class Offer(Endpoint):
    """Offer a topic with a publisher of our own, at this moment; ``Feed(name, ...)`` uses it."""

    qos: Qos = EVERYONE
    asks = 'subscription'


@dataclass(frozen=True)
class Leave(Step):
    """
    Take away what a :class:`Join`, an :class:`Offer` or :attr:`Scenario.feed` has brought.

    :param name: as there
    """

    name: str

    def mistakes(self, there: There) -> Iterator[str]:
        """Refuse a name that nobody announced, and take it away."""
        announced = set().union(*there.values())
        if self.name not in announced:
            yield _not_announced(self.name, announced)
        for names in there.values():
            names.discard(self.name)


@dataclass(frozen=True)
class Mark(Step):
    """
    Begin a phase of the run, see :meth:`autograder.recording.Recording.phase`.

    :param name: how checks ask for it
    """

    name: str


@dataclass(frozen=True)
class Look(Step):
    """
    Write down the graph as it is now, besides those of the start and of the end.

    :param when: how checks ask for it: ``recording.of('graph', when=...)``
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


def set_parameter(node: str, name: str, value: bool | int | float | str) -> Call:
    """Return the call that sets one parameter of a node."""
    number, word = PARAMETER_TYPES[type(value)]
    # JSON has no NaN and no infinity.
    told = value if not isinstance(value, float) or math.isfinite(value) else str(value)
    wanted = {'name': name, 'value': {'type': number, f'{word}_value': told}}
    return Call(
        node, 'set_parameters', 'rcl_interfaces/srv/SetParameters', {'parameters': [wanted]}
    )


def transition(node: str, name: str) -> Call:
    """
    Return the call that asks a lifecycle node for a transition.

    :param name: ``configure``, ``activate``, ``deactivate`` or ``cleanup``
    """
    wanted = {'transition': {'id': TRANSITIONS[name]}}
    return Call(node, 'change_state', 'lifecycle_msgs/srv/ChangeState', wanted)


def state(node: str) -> Call:
    """Return the call that asks a lifecycle node for its state."""
    return Call(node, 'get_state', 'lifecycle_msgs/srv/GetState')


@dataclass(frozen=True)
class Scenario:
    """
    What the probe does.  It holds inputs and never an expected value.

    :param program: what runs in the sandbox: ``'node'`` the node file, ``'build'`` a build of the
        student's package followed by a node that sends back what it receives, ``'package'`` a
        build followed by the package's executable of the file's name, ``'check'`` the function
        ``accepts(run)`` of the file, which is asked about each recorded run that the probe sends
        on ``/runs`` and answers on ``/answers``, ``''`` nothing: then every check is static
    :param file: the node file to run, for ``'node'``
    :param arguments: of the program, after ``--ros-args``, such as
        ``('-r', '__ns:=/lab', '-p', 'threshold:=28.5')``; for ``'package'``, ``{share}`` is the
        folder of its installed files
    :param build_type: for ``'build'``, the message that travels from ``/echo_in`` to
        ``/echo_out``, such as ``robot_msgs/msg/Speed``; the package is named in it;
        for ``'package'`` the package's name
    :param watch: topics to record, full name to type such as ``'std_msgs/msg/String'``
    :param feed: topics to send on, likewise, or with a :class:`FeedTopic`
    :param appear_s: how long the first node may take [s]
    :param ros_clock: the ``/clock`` that the program follows, None for the clock of the computer
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
        """Return the scenario as the probe reads it, without the probe's name."""
        feed = {topic: asdict(one) for topic, one in self.feeds.items()}
        return {**asdict(self), 'feed': feed, 'steps': [step.to_json() for step in self.steps]}

    @property
    def package_facts(self) -> Mapping[str, str]:
        """Return the names of the package that is built and of its executable, or nothing."""
        if self.program != 'package':
            return {}
        return {'package': self.build_type, 'executable': self.file.removesuffix('.py')}

    @property
    def feeds(self) -> Mapping[str, FeedTopic]:
        """Return the topics to send on, each with its quality of service."""
        given = self.feed.items()
        return {topic: FeedTopic(one) if isinstance(one, str) else one for topic, one in given}

    def placed(self) -> Iterator[tuple[str, Step]]:
        """Yield each step with the place that a mistake in it names."""
        for number, step in enumerate(self.steps, 1):
            label = f' {getattr(step, step.label)!r}' if step.label else ''
            yield f'step {number} ({type(step).__name__}){label}', step

    def endpoints(self) -> Iterator[tuple[str, str, str]]:
        """Yield what the program should have: publisher or subscription, full topic name, type."""
        yield from (('publisher', topic, name) for topic, name in self.watch.items())
        yield from (('subscription', topic, one.type) for topic, one in self.feeds.items())
        ends = (step for step in self.steps if isinstance(step, Endpoint))
        yield from ((end.asks, end.topic, end.type) for end in ends)

    def types(self) -> Iterator[tuple[str, str, str]]:
        """Yield every type the probe will load: its place, the topic or no name, and the type."""
        yield from ((f'watch {topic!r}', topic, name) for topic, name in self.watch.items())
        yield from ((f'feed {topic!r}', topic, one.type) for topic, one in self.feeds.items())
        for place, step in self.placed():
            if isinstance(step, (Call, Endpoint)):
                yield place, step.name if isinstance(step, Endpoint) else '', step.type

    def mistakes(self) -> Iterator[str]:
        """Yield what the scenario contradicts in itself, each with its place."""
        for place, topic, name in self.types():
            kind = 'msg' if topic else 'srv'
            if not _TYPE.match(name) or f'/{kind}/' not in name:
                yield f'{place}: expected a type such as {_EXAMPLES[kind]}, got {name!r}'
        for word, topics in (('watch', self.watch), ('feed', self.feed)):
            for topic in (one for one in topics if not one.startswith('/')):
                yield f'{word} {topic!r}: expected a full topic name, got no slash at its start'
        there = {'publisher': set[str](), 'subscription': set(self.feed)}
        for place, step in self.placed():
            yield from (f'{place}: {one}' for one in step.mistakes(there))
