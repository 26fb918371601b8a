"""
Write an MCAP file that Foxglove, PlotJuggler and ``ros2 bag`` can open.

A recorder writes the messages of live topics as bytes, as the publisher serialised them.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial
import os
from pathlib import Path
import time
from typing import Any, TYPE_CHECKING

from mcap.writer import CompressionType, Writer
from rcl_interfaces.msg import Log
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from rclpy.subscription import Subscription
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from roslab.bags.bag import Bag, BagTopic, plain_profiles
from roslab.cli_text import to_yaml
from roslab.errors import RoslabError
from roslab.ros2.graph import qos_for_publishers
from roslab.ros2.interface import definition_of, hash_of, interface_class

if TYPE_CHECKING:
    from autograder.simulated import LogRecord, Simulation

DISTRO = 'jazzy'
_DEPTH = 1000
"""How many messages may wait for the next callback, so that a burst is not lost."""


class BagWriter:
    """
    Writes one MCAP file; use it in a ``with`` statement.

    The file gets its name at the end, even after an interrupt.  Without messages, no file is
    written, and an existing file with that name is kept.

    :param path: the file, which is replaced at the end
    :raises OSError: if its folder cannot be written
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.bag: Bag | None = None
        self._unfinished = path.with_name(f'.{path.name}.{os.getpid()}')
        self._file = self._unfinished.open('wb')
        # Do not compress, like ros2 bag: some readers lack zstd.
        self._mcap = Writer(self._file, compression=CompressionType.NONE)
        self._mcap.start(profile='ros2', library='roslab')
        self._topics: dict[str, BagTopic] = {}
        self._channels: dict[str, int] = {}
        self._counts: dict[str, int] = {}
        self._times: tuple[int, int] | None = None

    @property
    def count(self) -> int:
        """Number of messages so far."""
        return sum(self._counts.values())

    def add_topic(self, name: str, type_name: str, profiles: Iterable[QoSProfile] = ()) -> None:
        """Add a topic, which may get no messages; LookupError if its type is not installed."""
        made = BagTopic(name, type_name, plain_profiles(profiles), hash_of(type_name), 0)
        definition = definition_of(type_name).encode()
        schema = self._mcap.register_schema(type_name, 'ros2msg', definition)
        about = {
            'offered_qos_profiles': to_yaml(list(made.profiles)),
            'topic_type_hash': made.hash,
        }
        self._channels[name] = self._mcap.register_channel(name, 'cdr', schema, about)
        self._topics[name], self._counts[name] = made, 0

    def write(self, topic: str, data: bytes, received_ns: int, sent_ns: int) -> None:
        """
        Add a message.

        :param topic: full name of a topic that was added
        :param received_ns: when it was received [ns since 1970]
        :param sent_ns: when it was published [ns since 1970]
        """
        self._mcap.add_message(self._channels[topic], received_ns, data, sent_ns)
        self._counts[topic] += 1
        first, last = self._times or (received_ns, received_ns)
        self._times = min(first, received_ns), max(last, received_ns)

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        """Complete the file, except after an error that is not an interrupt."""
        try:
            if self._times and (error is None or not isinstance(error, Exception)):
                topics = (
                    replace(one, count=self._counts[name])
                    for name, one in sorted(self._topics.items())
                )
                bag = Bag(self.path, (self.path,), tuple(topics), *self._times, DISTRO)
                self._mcap.add_metadata(
                    'rosbag2', {'serialized_metadata': to_yaml(bag.metadata())}
                )
                self._mcap.finish()
                self._file.close()
                self._unfinished.replace(self.path)
                self.bag = bag
        finally:
            self._file.close()
            self._unfinished.unlink(missing_ok=True)


class Recorder:
    """
    Records topics as soon as they have a publisher.

    Callbacks only store messages, because they may run in another thread; :meth:`drain` writes.

    :param node: a node that something else spins
    :param tell: called with the name of each topic to which the recorder subscribes
    """

    def __init__(
        self,
        node: Node,
        writer: BagWriter,
        topics: Iterable[str] = (),
        tell: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.node = node
        self.heard: deque[tuple[str, bytes, int, int]] = deque()
        self.subscriptions: dict[str, Subscription] = {}
        self.refused: dict[str, str] = {}
        self._writer = writer
        self._topics = set(topics)
        self._tell = tell

    def look(self) -> None:
        """Subscribe to topics that have gained a publisher since the last check."""
        for name, types in self.node.get_topic_names_and_types():
            if name in self.subscriptions or name in self.refused:
                continue
            asked = name in self._topics if self._topics else not topic_or_service_is_hidden(name)
            if asked and self.node.count_publishers(name):
                self._subscribe(name, types)

    def _subscribe(self, name: str, types: list[str]) -> None:
        if len(types) > 1:
            self.refused[name] = f'{name} has several types, {" and ".join(types)}.'
            return
        offered = [one.qos_profile for one in self.node.get_publishers_info_by_topic(name)]
        qos = qos_for_publishers(self.node, name, _DEPTH)
        try:
            kind = interface_class(types[0])
            self._writer.add_topic(name, types[0], offered)
        except LookupError:
            self.refused[name] = f'The type of {name}, {types[0]}, is not installed here.'
            return
        self.subscriptions[name] = self.node.create_subscription(
            kind, name, partial(_store, self.heard, name), qos, raw=True
        )
        self._tell(name)

    def drain(self) -> None:
        """Write the messages that have arrived."""
        while self.heard:
            self._writer.write(*self.heard.popleft())


def _store(heard: deque[tuple[str, bytes, int, int]], name: str, data: bytes, about: Any) -> None:
    received_ns = about['received_timestamp'] or time.time_ns()
    heard.append((name, data, received_ns, about['source_timestamp'] or received_ns))


def write_simulation(run: Simulation, writer: BagWriter) -> None:
    """
    Write the messages and log lines of a simulation, and the inputs that were sent to it.

    Second 0 of the simulation becomes the beginning of 1970.

    :raises RoslabError: if a type is not installed, or a message was too long to be stored
    """
    rows: list[tuple[float, str, Any]] = []
    types: dict[str, str] = {}
    for name, record in [*run.sent.items(), *run.heard.items()]:
        try:
            messages = record.messages
        except (ImportError, AttributeError):
            raise RoslabError(
                f'{name}: its type {record.type} is not installed here. Try: build_messages()'
            ) from None
        if None in messages:
            raise RoslabError(f'{name}: the simulation does not keep messages of more than 64 KB.')
        types[name] = record.type
        rows += [(time_s, name, message) for time_s, message in zip(record.times, messages)]
    if run.logs:
        types['/rosout'] = 'rcl_interfaces/msg/Log'
        rows += [(line.time_s, '/rosout', _log(line)) for line in run.logs]
    for name, kind in types.items():
        writer.add_topic(name, kind)
    for time_s, name, message in sorted(rows, key=lambda row: row[0]):
        when = round(time_s * 10**9)
        writer.write(name, serialize_message(message), when, when)


def _log(line: LogRecord) -> Log:
    made = Log(name=line.logger, msg=line.text, level=getattr(Log, line.level))
    made.stamp.sec, made.stamp.nanosec = divmod(round(line.time_s * 10**9), 10**9)
    return made
