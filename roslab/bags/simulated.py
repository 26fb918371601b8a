"""Save what a simulated program did as a bag."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import Log
from rclpy.serialization import serialize_message

from autograder.simulated import LogRecord, Simulation
from roslab.bags.writer import BagWriter
from roslab.errors import RoslabError

_NS = 10**9
_LOG = '/rosout'


def write_simulation(run: Simulation, writer: BagWriter) -> None:
    """
    Write the messages and log lines of a simulation, and the inputs that it was sent.

    Second 0 of the simulation becomes the beginning of 1970.

    :raises RoslabError: if a type is not installed, or a message was too long to be kept
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
            raise RoslabError(f'{name}: the simulation keeps no messages of more than 64 KB.')
        types[name] = record.type
        rows += [(time, name, message) for time, message in zip(record.times, messages)]
    if run.logs:
        types[_LOG] = 'rcl_interfaces/msg/Log'
        rows += [(line.time_s, _LOG, _log(line)) for line in run.logs]
    for name, kind in types.items():
        writer.add_topic(name, kind)
    for time, name, message in sorted(rows, key=lambda row: row[0]):
        when = round(time * _NS)
        writer.write(name, serialize_message(message), when, when)


def _log(line: LogRecord) -> Log:
    made = Log(name=line.logger, msg=line.text, level=getattr(Log, line.level))
    made.stamp.sec, made.stamp.nanosec = divmod(round(line.time_s * _NS), _NS)
    return made
