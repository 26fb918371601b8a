"""
Define the steps of a scenario, which the probe executes in order, as data.

Steps contain inputs, but never an expected value.  Most exams need only ``Advance`` and ``Feed``.
``Call`` calls a service of the student's node; ``Offer`` and ``Join`` add a publisher or a
subscription of the probe, ``Leave`` removes one, and ``Watch`` records a topic again; ``Mark``
begins a phase that checks can select; ``Look`` records the graph.

All seconds are virtual and exact; 60 virtual seconds take about 0.1 s of real time.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from difflib import get_close_matches
import math
from typing import Any, ClassVar

BURST = 10
"""Maximum number of messages at once: a subscription of depth 10 keeps them all."""
SETTLE_S = 0.2  # duration of a step that adds or removes an endpoint, see probe_run.py [s]
TRANSITIONS = {'configure': 1, 'cleanup': 2, 'activate': 3, 'deactivate': 4}
PARAMETER_TYPES = {
    bool: (1, 'bool'),
    int: (2, 'integer'),
    float: (3, 'double'),
    str: (4, 'string'),
}


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
        """Yield contradictions with earlier steps, and update the set of endpoints."""
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
        if self.burst and len(self.messages) > BURST:
            yield f'expected at most {BURST} messages per burst, got {len(self.messages)}'

    def sends(self) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        """Yield the messages."""
        for which, message in enumerate(self.messages, 1):
            yield f': message {which}', self.topic, message


def feeds(topic: str, messages: Sequence[Mapping[str, Any]], burst: int, **how: Any) -> list[Feed]:
    """Return the steps that send messages one by one and the last ``burst`` ones at once."""
    singles = len(messages) - burst
    last = [Feed(topic, messages[singles:], burst=True, **how)] if burst else []
    return [Feed(topic, messages[:singles], **how), *last]


@dataclass(frozen=True)
class Call(Step):
    """
    Call a service of the student's node once, and record ``answer`` or ``no_answer``.

    :param service: last part of the name, such as ``set_parameters``, or a full name with a slash
    :param type: such as ``rcl_interfaces/srv/SetParameters``
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
        return {**super().to_json(), 'service': self.name}

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
    :param copies: number of subscriptions that join in the same moment, all with this name
    """

    qos: Qos = Qos()
    listen_s: float = 0.4
    copies: int = 1
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
    """Subscribe again to a topic of :attr:`Scenario.watch` after a :class:`Leave`."""

    topic: str
    label = 'topic'

    def mistakes(self, there: There) -> Iterator[str]:
        """Reject a topic that is not recorded."""
        if self.topic not in there['watch']:
            yield f'expected a topic of Scenario(watch=...), got {self.topic!r}'


def unheard(topic: str, seconds: float) -> tuple[Step, ...]:
    """Return the steps in which time passes without a subscription on a recorded topic."""
    return (Leave(topic), Advance(seconds - SETTLE_S), Watch(topic))


@dataclass(frozen=True)
class Mark(Step):
    """Begin a phase of the run, see :meth:`autograder.recording.Recording.phase`."""

    name: str


@dataclass(frozen=True)
class Look(Step):
    """Record the current graph, in addition to the graphs at the start and at the end."""

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
    """Return the call that sets parameters of a node, atomically either all of them or none."""
    wanted = []
    for name, value in values.items():
        number, word = PARAMETER_TYPES[type(value)]
        wanted.append({'name': name, 'value': {'type': number, f'{word}_value': value}})
    service = 'set_parameters_atomically' if atomically else 'set_parameters'
    kind = f'rcl_interfaces/srv/SetParameters{"Atomically" if atomically else ""}'
    return Call(node, service, kind, {'parameters': wanted})


def get_parameters(node: str, names: Sequence[str] = (), patience_s: float = 5.0) -> Call:
    """Return the call that requests parameters; without any, it shows that the node answers."""
    kind = 'rcl_interfaces/srv/GetParameters'
    request = {'names': list(names)} if names else {}
    return Call(node, 'get_parameters', kind, request, patience_s)


def read_parameters(node: str, names: Iterable[str]) -> list[Call]:
    """Return a call for each parameter, because one unknown name leaves all others unread."""
    return [get_parameters(node, [name]) for name in names]


def transition(node: str, name: str) -> Call:
    """Return the call that requests a transition, a key of :data:`TRANSITIONS`."""
    wanted = {'transition': {'id': TRANSITIONS[name]}}
    return Call(node, 'change_state', 'lifecycle_msgs/srv/ChangeState', wanted)


def state(node: str) -> Call:
    """Return the call that requests the state of a lifecycle node."""
    return Call(node, 'get_state', 'lifecycle_msgs/srv/GetState')
