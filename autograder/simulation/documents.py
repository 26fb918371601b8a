"""Describe a simulation: the order says what to run and to send, the result what happened."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
import math
from typing import Any

from autograder.errors import UsageError
from autograder.recording import Event, LEVELS, Recording
from autograder.simulated import LogRecord, Simulation, TopicRecord

MAX_SECONDS = 86_400.0


@dataclass(frozen=True)
class Input:
    """
    A message to send.

    :param at_s: when to send it [s since the program starts]
    :param fields: values of its fields; other fields keep their defaults
    :param type: type of the message; empty for the type of the program's subscription
    """

    at_s: float
    topic: str
    fields: Mapping[str, Any]
    type: str = ''


@dataclass(frozen=True)
class Order:
    """
    The input of a simulation: what to run, for how long, and what to send.

    :param seconds: how long to run, in virtual time from the start of the program [s]
    :param inputs: messages to send; messages with the same time are sent as a burst
    :param late: time at which an additional subscription joins [s], by full topic name
    :param arguments: arguments of the program, after ``--ros-args``
    """

    file: str
    seconds: float
    inputs: Sequence[Input]
    late: Mapping[str, float]
    arguments: Sequence[str]


def order_of(
    file: str,
    seconds: float,
    inputs: Mapping[str, Sequence[tuple[float, Any]]] | None = None,
    late: Mapping[str, float] | None = None,
    arguments: Sequence[str] = (),
) -> Order:
    """
    Return the order for a user's arguments; topics may lack the leading slash.

    :param inputs: pairs of a time [s] and a message (or a dict of its fields), by topic
    :raises UsageError: if an argument has a wrong form, or a time is invalid
    """
    try:
        sent = [
            _input(topic, at_s, message)
            for topic, pairs in (inputs or {}).items()
            for at_s, message in pairs
        ]
        joins = {_full(topic): float(at_s) for topic, at_s in (late or {}).items()}
        order = Order(file, float(seconds), sent, joins, tuple(arguments))
    except (AttributeError, TypeError, ValueError) as error:
        raise UsageError(
            f'{file}: expected seconds as numbers, inputs={{topic: [(second, message), ...]}} and '
            f'late={{topic: second}}, got something else: {error}.'
        ) from error
    if not 0 < order.seconds <= MAX_SECONDS:
        raise UsageError(
            f'seconds: expected more than 0 and at most {MAX_SECONDS:.0f}, got {order.seconds}.'
        )
    times = [(f'inputs of {one.topic}', one.at_s) for one in sent]
    times += [(f'late {topic}', at_s) for topic, at_s in joins.items()]
    for where, at_s in times:
        if not 0 <= at_s <= order.seconds:  # also refuses NaN
            raise UsageError(
                f'{where}: expected a time from 0 to {order.seconds:g} s, got {at_s}.'
            )
    return order


def _input(topic: str, at_s: float, message: Any) -> Input:
    if isinstance(message, Mapping):
        return Input(float(at_s), _full(topic), _plain(message))
    if not hasattr(message, 'get_fields_and_field_types'):
        raise TypeError(f'{message!r} is neither a message nor a dict of fields')
    package, kind = type(message).__module__.split('.')[:2]
    name = f'{package}/{kind}/{type(message).__name__}'
    return Input(float(at_s), _full(topic), _plain(message), name)


def _full(topic: str) -> str:
    return topic if topic.startswith('/') else f'/{topic}'


def _plain(value: Any) -> Any:
    """Convert the value of a field to JSON types."""
    if isinstance(value, Mapping):
        return {str(name): _plain(one) for name, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, (str, int)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    # Import this only here: the grader's own process never imports rclpy.
    from autograder.probe.probe_wire import to_json

    return to_json(value)


def read_simulation(recording: Recording) -> Simulation:
    """
    Return the simulation that a recording describes.

    :param recording: made by :func:`autograder.simulation.run.record`, whose header contains the
        end of the simulation [s since the program started] and the types of the topics
    """
    about, end_ns = recording.header, round(recording.header['seconds'] * 1e9)
    within = [one for one in recording.events if (one.get('clock_ns') or 0) <= end_ns]
    over_ns = recording.of('end')[-1]['clock_ns']
    if over_ns is None:  # a limit ended the run; use the time of the last event
        over_ns = max(one.get('clock_ns') or 0 for one in within)
    # A program that ended after the requested time completed the simulation.
    ended_later = recording.end_reason == 'student_exited' and over_ns > end_ns
    complete = ended_later or recording.end_reason == 'complete'
    seconds, events = min(over_ns, end_ns) / 1e9, Recording(about, within)
    published, sent, process = about['published'], about['sent'], recording.process

    def record(name: str, found: Sequence[Event], of_type: str) -> TopicRecord:
        times = tuple(one['clock_ns'] / 1e9 for one in found)
        data = tuple(one.get('data') for one in found)
        return TopicRecord(name, of_type, times, data, seconds)

    late = {one['topic']: one['listener'] for one in events.of('joined')}
    return Simulation(
        about['exam'],
        heard={to: record(to, events.messages(to), kind) for to, kind in published.items()},
        late={
            to: record(f'{to} (late)', events.messages(to, by), published[to])
            for to, by in late.items()
        },
        sent={
            to: record(f'{to} (input)', events.of('input', topic=to), kind)
            for to, kind in sent.items()
        },
        logs=tuple(map(_log, events.of('log'))),
        reason='complete' if complete else recording.end_reason,
        seconds=seconds,
        exit=None if complete else process['exit'],
        printed=process['stdout'] + process['stderr'],
        mode=about['mode'],
    )


def _log(event: Event) -> LogRecord:
    level = LEVELS.get(event['level'], str(event['level']))
    return LogRecord(event['clock_ns'] / 1e9, level, event['name'], event['text'])
