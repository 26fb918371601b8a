"""
Represent what a program did in virtual time, for notebooks, pytest and students' checks.

The classes have the same interface as a notebook's listener, so pictures can show a simulation in
the same way as live messages.  A student's check of recorded runs gets the same objects in the
sandbox, so this file imports only the standard library and ``autograder/probe/probe_wire.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

ENDS = {
    'complete': 'the simulation was complete',
    'student_exited': 'the program ended',
    'no_node': 'no node had appeared',
    'not_connected': 'no node was subscribed when an input was due',
    'cpu_limit': 'the program had used more than 20 s of processor time',
    'too_many_events': 'there were more than 20000 messages and log lines',
    'too_much_recorded': 'there were more than 32 MB of messages',
    'output_limit': 'the program had printed more than 8 MB',
    'memory_limit': 'the program used more than 1 GiB of memory',
    'disk_limit': 'the files of the program used more than 64 MB',
    'inode_limit': 'the program had more than 20000 files',
    'probe_broken': 'the recorder could not handle the messages',
    'waits_outside': 'the program waited for something outside Python and ROS',
    'busy_before_node': 'the program had computed for 3 s without creating a node',
}
"""Descriptions of why a simulation ended, by the reason in its recording."""


@dataclass(frozen=True)
class TopicRecord:
    """
    The messages of a topic, with the interface of a stopped listener.

    :param topic: full name of the topic, followed by ``(late)`` for a late subscription and
        ``(input)`` for inputs
    :param type: type of the messages, such as ``std_msgs/msg/String``
    :param times: when each message was received, or sent [s since the program started]
    :param data: fields of each message, or None for a message of more than 64 KB
    :param seconds: duration of the simulation in virtual time [s]
    """

    topic: str
    type: str
    times: tuple[float, ...]
    data: tuple[Mapping[str, Any] | None, ...]
    seconds: float
    began = 0.0
    alive = False

    @property
    def msg_type(self) -> Any:
        """The class of the messages; ModuleNotFoundError if its package cannot be imported."""
        # Import this only here: the grader's own process never imports rclpy.
        from autograder.probe.probe_wire import load_type

        return load_type(self.type)

    @property
    def messages(self) -> list[Any]:
        """The messages, oldest first."""
        from autograder.probe.probe_wire import fill

        made = self.msg_type
        return [None if data is None else fill(made(), dict(data)) for data in self.data]

    def wait(self, count: int = 1, timeout: float = 0.0) -> list[Any]:
        """Return the messages without waiting, because no more messages arrive."""
        return self.messages

    def stop(self) -> None:
        """Do nothing, because the simulation has already ended."""

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[Any]:
        return iter(self.messages)


@dataclass(frozen=True)
class LogRecord:
    """
    A log line.

    :param time_s: when the probe received the log line [s since the program started]
    :param level: 'DEBUG', 'INFO', 'WARN', 'ERROR' or 'FATAL'
    """

    time_s: float
    level: str
    logger: str
    text: str

    def __str__(self) -> str:
        return f'{self.time_s:.3f} s  {self.level:<5}  {self.logger}: {self.text}'


@dataclass(frozen=True)
class Simulation:
    """
    A program's messages and log lines in virtual time.

    Simulations with the same messages and log lines compare equal.

    :param heard: messages that the program published, by the full name of the topic
    :param late: messages that late subscriptions received, by the full name of the topic
    :param sent: inputs that were sent, by the full name of the topic
    :param logs: log lines, oldest first
    :param reason: why the simulation ended, a key of :data:`ENDS`; ``'complete'`` if it lasted as
        long as requested
    :param seconds: duration of the simulation in virtual time [s]
    :param exit: exit code of the program, or None if it did not end
    :param printed: the beginning and the end of the printed output, standard error last
    """

    program: str
    heard: Mapping[str, TopicRecord]
    late: Mapping[str, TopicRecord]
    sent: Mapping[str, TopicRecord]
    logs: tuple[LogRecord, ...]
    reason: str
    seconds: float
    exit: int | None = None
    printed: str = field(default='', compare=False, repr=False)
    mode: str = field(default='', compare=False, repr=False)

    @property
    def listeners(self) -> list[TopicRecord]:
        """The rows of a timeline: inputs, published messages and late subscriptions."""
        return [*self.sent.values(), *self.heard.values(), *self.late.values()]

    def __getitem__(self, topic: str) -> TopicRecord:
        name = topic if topic.startswith('/') else f'/{topic}'
        if name not in self.heard:
            known = ', '.join(self.heard) or 'none'
            raise KeyError(f'{name}: the program has no such publisher; its topics: {known}')
        return self.heard[name]

    def messages(self, topic: str) -> list[Any]:
        """
        Return the messages that the program published on a topic, oldest first.

        :param topic: name of the topic, with or without the leading slash
        :raises KeyError: if the program has no publisher on the topic
        """
        return self[topic].messages

    def times(self, topic: str) -> list[float]:
        """
        Return when the program published on a topic [s since the program started].

        :param topic: name of the topic, with or without the leading slash
        :raises KeyError: if the program has no publisher on the topic
        """
        return list(self[topic].times)

    def logged(self, level: str) -> list[LogRecord]:
        """Return the log lines of one level, such as ``'WARN'``."""
        return [line for line in self.logs if line.level == level.upper()]

    @property
    def ended(self) -> str:
        """One sentence that says when and why the simulation ended."""
        why = ENDS.get(self.reason, f'a limit was reached ({self.reason})')
        words = f'After {self.seconds:g} s of virtual time, {why}'
        if self.exit is not None:
            words += f' with exit code {self.exit}'
        said = self.printed.strip().splitlines()
        return f'{words}: {said[-1].strip()}' if self.exit and said else f'{words}.'

    def to_json(self) -> dict[str, Any]:
        """Convert the simulation to JSON types."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Simulation:
        """Create a simulation from the output of :meth:`to_json`."""
        topics = {
            kind: {topic: TopicRecord(**one) for topic, one in data[kind].items()}
            for kind in ('heard', 'late', 'sent')
        }
        logs = tuple(LogRecord(**line) for line in data['logs'])
        return cls(**{**data, **topics, 'logs': logs})

    def __str__(self) -> str:
        rows = [(record.topic, len(record), 'messages') for record in self.listeners]
        rows.append(('log', len(self.logs), 'lines'))
        width = max(len(name) for name, *_ in rows)
        counts = (f'  {name:<{width}}  {count} {what}' for name, count, what in rows)
        return '\n'.join([f'{self.program}: {self.ended}', *counts])

    def __repr__(self) -> str:
        return str(self)
