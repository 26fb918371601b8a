"""Write messages to an MCAP file that Foxglove, PlotJuggler and ``ros2 bag`` can open."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
import os
from pathlib import Path
from typing import Any, TYPE_CHECKING

from mcap.writer import CompressionType, Writer
from rcl_interfaces.msg import Log
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message

from roslab.bags.bag import Bag, BagTopic, plain_profiles
from roslab.cli_text import to_yaml
from roslab.errors import RoslabError
from roslab.ros2.interface import definition_of, hash_of

if TYPE_CHECKING:
    from autograder.simulated import LogRecord, Simulation

DISTRO = 'jazzy'


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
        rows += [(time, name, message) for time, message in zip(record.times, messages)]
    if run.logs:
        types['/rosout'] = 'rcl_interfaces/msg/Log'
        rows += [(line.time_s, '/rosout', _log(line)) for line in run.logs]
    for name, kind in types.items():
        writer.add_topic(name, kind)
    for time, name, message in sorted(rows, key=lambda row: row[0]):
        when = round(time * 10**9)
        writer.write(name, serialize_message(message), when, when)


def _log(line: LogRecord) -> Log:
    made = Log(name=line.logger, msg=line.text, level=getattr(Log, line.level))
    made.stamp.sec, made.stamp.nanosec = divmod(round(line.time_s * 10**9), 10**9)
    return made
