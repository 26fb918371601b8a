"""
Show the log lines of nodes as a table.

Lines are recorded where rclpy passes them to the logging library, after log levels and filters
such as ``once`` are applied.  So discovery and queues cannot lose lines, loggers without a node
are included, and a line is in the table as soon as the logging call returns.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
import html
import time
from typing import Any, NamedTuple

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from autograder.recording import LEVELS
from drawing.svg import ORANGE, RED
from roslab.output import text_table

_MOST_LINES = 5000
_TINTS = {'WARN': f'{ORANGE}29', 'ERROR': f'{RED}29', 'FATAL': f'{RED}29'}
"""Transparent, because no colour of letters is readable on both a light and a dark page."""
_HOOK = 'rclpy_logging_rcutils_log'


class LogLine(NamedTuple):
    """
    One line that a node logged.

    :param stamp_s: wall-clock time [s]
    :param level: 'DEBUG', 'INFO', 'WARN', 'ERROR' or 'FATAL'
    :param logger: name of the logger; for a node, its namespace and name joined by dots
    """

    stamp_s: float
    level: str
    logger: str
    message: str


class LogTable(tuple[LogLine, ...]):
    """A sequence of log lines, oldest first, shown as a table."""

    @property
    def messages(self) -> list[str]:
        """The messages of the lines, without levels and logger names."""
        return [line.message for line in self]

    def at_level(self, level: str) -> LogTable:
        """Return only the lines of one level, such as 'WARN'."""
        return LogTable(line for line in self if line.level == level.upper())

    def __repr__(self) -> str:
        if not self:
            return 'No log lines.'
        return text_table([_cells(line) for line in self])

    def _repr_html_(self) -> str:
        rows = ''.join(
            f'<tr style="background: {_TINTS.get(line.level, "none")}">'
            + ''.join(
                f'<td style="text-align: left">{html.escape(cell)}</td>' for cell in _cells(line)
            )
            + '</tr>'
            for line in self
        )
        head = ''.join(
            f'<th scope="col" style="text-align: left">{name}</th>'
            for name in ('time', 'level', 'logger', 'message')
        )
        return f'<table><caption>{len(self)} log lines</caption><tr>{head}</tr>{rows}</table>'


class _Recorder:
    """A replacement for the C function that rclpy's loggers call."""

    def __init__(self) -> None:
        self.lines: deque[LogLine] = deque(maxlen=_MOST_LINES)
        self.on_line: Callable[[LogLine], object] = lambda line: None
        self._write = getattr(rclpy_implementation, _HOOK)
        setattr(rclpy_implementation, _HOOK, self)

    def __call__(self, severity: Any, name: str, message: str, *place: Any) -> None:
        if not isinstance(message, str):
            # In this case rclpy raises an exception, so there is no line to store.
            self._write(severity, name, message, *place)
            return
        level = LEVELS.get(int(severity), str(severity))
        line = LogLine(time.time(), level, str(name), message)
        self.on_line(line)
        self._write(severity, name, message, *place)
        self.lines.append(line)  # last, so that a waiting cell finds only lines already shown


_recorder: _Recorder | None = None


def record_logs(on_line: Callable[[LogLine], object] | None = None) -> None:
    """Start recording log lines, unless recording has already started."""
    global _recorder
    _recorder = _recorder or _Recorder()
    _recorder.on_line = on_line or _recorder.on_line


def logs(node: Node | str | None = None) -> LogTable:
    """
    Return the log lines recorded in this notebook so far, as a table.

    :param node: return only the lines of this node (a node or its name) and its child loggers
    """
    lines = tuple(_recorder.lines) if _recorder else ()
    if node is None:
        return LogTable(lines)
    name = node if isinstance(node, str) else node.get_fully_qualified_name()
    logger = name.strip('/').replace('/', '.')
    return LogTable(line for line in lines if f'{line.logger}.'.startswith(f'{logger}.'))


def _cells(line: LogLine) -> tuple[str, str, str, str]:
    clock = time.strftime('%H:%M:%S', time.localtime(line.stamp_s))
    clock = f'{clock}.{int(line.stamp_s % 1 * 1000):03d}'
    return clock, line.level, line.logger, line.message
