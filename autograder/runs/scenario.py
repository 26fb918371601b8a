"""
What the probe does, as data: the steps of a scenario, in order.

Steps hold inputs and never an expected value.  ``Advance`` and ``Feed`` are most of what an exam
needs; ``Call`` asks a service of the student's node; ``Offer``, ``Join`` and ``Leave`` let a
publisher or a subscription of ours come and go; ``Mark`` begins a phase, so that a check can ask
what happened in it; ``Look`` writes down the graph; ``Await`` waits for what follows wall time,
such as a missed deadline.

Write an ``Await(logs=1)`` after the first step that makes a node log: the first line can be a
tenth of a second late, while our reader fetches the history of ``/rosout``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

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
"""What satisfies a subscription of any reliability and durability."""


@dataclass(frozen=True)
class FeedTopic:
    """A topic to send on, with a quality of service of its own."""

    type: str
    qos: Qos = EVERYONE


@dataclass(frozen=True)
class Advance:
    """
    Move simulated time forward in equal steps.

    The step must be at most a quarter of the period that is examined: a timer that is stepped by
    whole periods fires once a step whatever its period.  For a program whose own timers ask for
    it, :mod:`autograder.judging.clock_steps` takes finer or longer steps.  ``phase_s`` puts the
    ticks off whole seconds, so that truncated or invented stamps show.  A later ``Advance`` with a
    phase of one step goes on with the ticks of the one before.

    :param seconds: simulated seconds
    :param step_s: length of one step [s]
    :param phase_s: the first clock value after the last one [s], below one period
    :param watch_s: wall seconds to watch code that does not follow the clock
    """

    seconds: float
    step_s: float = 0.25
    phase_s: float = 0.1
    watch_s: float = 3.0

    @property
    def count(self) -> int:
        """Return how many times the clock moves."""
        return round(self.seconds / self.step_s)

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it, in whole nanoseconds."""
        return {
            'do': 'advance',
            'steps': self.count,
            'step_ns': round(self.step_s * 1e9),
            'first_ns': round(self.phase_s * 1e9),
            'watch_s': self.watch_s,
        }


@dataclass(frozen=True)
class Feed:
    """
    Send messages on a topic, one after the other or as one burst of at most ten.

    :param topic: full topic name, announced in :attr:`Scenario.feed`, or the name of an
        :class:`Offer`
    :param messages: fields of each message
    :param optional: nobody needs to be connected; else the run ends where nobody is
    """

    topic: str
    messages: Sequence[Mapping[str, Any]]
    burst: bool = False
    optional: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {
            'do': 'feed',
            'topic': self.topic,
            'messages': [dict(message) for message in self.messages],
            'burst': self.burst,
            'optional': self.optional,
        }


@dataclass(frozen=True)
class Call:
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

    @property
    def name(self) -> str:
        """Return the service's full name."""
        return self.service if self.service.startswith('/') else f'{self.node}/{self.service}'

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {
            'do': 'call',
            'service': self.name,
            'type': self.type,
            'request': dict(self.request),
            'patience_s': self.patience_s,
        }


@dataclass(frozen=True)
class Join:
    """
    Join a topic with a subscription of our own, at this moment.

    What it hears is recorded with ``listener``, and ``joined`` tells whether it was matched.

    :param name: of the subscription, without a slash
    :param topic: full topic name
    :param listen_s: how long to listen before the next step, once nothing more comes [s]; what a
        late joiner is sent can be a tenth of a second late
    """

    name: str
    topic: str
    type: str
    qos: Qos = Qos()
    listen_s: float = 0.4

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {'do': 'join', **asdict(self)}


@dataclass(frozen=True)
class Offer:
    """
    Offer a topic with a publisher of our own, at this moment; ``Feed(name, ...)`` sends with it.

    :param name: of the publisher, without a slash
    :param topic: full topic name
    """

    name: str
    topic: str
    type: str
    qos: Qos = EVERYONE

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {'do': 'offer', **asdict(self)}


@dataclass(frozen=True)
class Leave:
    """
    Take away what a :class:`Join`, an :class:`Offer` or :attr:`Scenario.feed` has brought.

    :param name: as there
    """

    name: str

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {'do': 'leave', 'name': self.name}


@dataclass(frozen=True)
class Mark:
    """
    Begin a phase of the run, see :meth:`autograder.runs.recording.Recording.phase`.

    :param name: how checks ask for it
    """

    name: str

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {'do': 'mark', 'name': self.name}


@dataclass(frozen=True)
class Look:
    """
    Write down the graph as it is now, besides those of the start and of the end.

    :param when: how checks ask for it: ``recording.of('graph', when=...)``
    """

    when: str

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {'do': 'look', 'when': self.when}


@dataclass(frozen=True)
class Await:
    """
    Wait in wall time for what the step before has caused, at most so long.

    :param logs: log lines since that step began
    :param messages: messages since then, on watched topics or at a :class:`Join`
    :param seconds: wall seconds, in which nobody waits for a processor
    """

    logs: int = 0
    messages: int = 0
    seconds: float = 3.0

    def to_json(self) -> dict[str, Any]:
        """Return the step as the probe reads it."""
        return {'do': 'await', **asdict(self)}


Step = Advance | Feed | Call | Join | Offer | Leave | Mark | Look | Await


def set_parameter(node: str, name: str, value: bool | int | float | str) -> Call:
    """Return the call that sets one parameter of a node."""
    number, word = PARAMETER_TYPES[type(value)]
    wanted = {'name': name, 'value': {'type': number, f'{word}_value': value}}
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
        build followed by the package's executable of the file's name, ``''`` nothing:
        then every check is static
    :param file: the node file to run, for ``'node'``
    :param arguments: of the program, after ``--ros-args -p use_sim_time:=true``, such as
        ``('-r', '__ns:=/lab', '-p', 'threshold:=28.5')``
    :param build_type: for ``'build'``, the message that travels from ``/echo_in`` to
        ``/echo_out``, such as ``temp_monitor_pkg/msg/Temperature``; the package is named in it;
        for ``'package'`` the package's name
    :param watch: topics to record, full name to type such as ``'std_msgs/msg/String'``
    :param feed: topics to send on, likewise, or with a :class:`FeedTopic`
    :param appear_s: wall budget until the first node is seen [s]; discovery is usually 0.1 s and
        rarely 3 s
    :param first_log_s: wall budget for the first input's log line [s]; 0 for a node that
        answers with messages
    :param stand_still_s: how long the clock stands still before each :class:`Advance`, to see who
        publishes all the same [s]; such a program is watched in wall time from there on
    """

    program: str = 'node'
    file: str = ''
    arguments: Sequence[str] = ()
    build_type: str = ''
    watch: Mapping[str, str] = field(default_factory=dict)
    feed: Mapping[str, str | FeedTopic] = field(default_factory=dict)
    steps: Sequence[Step] = ()
    appear_s: float = 10.0
    first_answer_s: float = 3.0
    answer_s: float = 5.0
    first_log_s: float = 3.0
    stand_still_s: float = 0.0

    def to_json(self) -> dict[str, Any]:
        """Return the scenario as the probe reads it, without the probe's name."""
        feed = {
            topic: asdict(one if isinstance(one, FeedTopic) else FeedTopic(one))
            for topic, one in self.feed.items()
        }
        return {**asdict(self), 'feed': feed, 'steps': [step.to_json() for step in self.steps]}
