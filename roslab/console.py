"""
Intercept the lines that ROS's C code writes to the console.

``rclpy`` passes each log line to C code, which writes it to the stdout of the process, publishes
it on ``/rosout`` and appends it to a file.  A notebook cannot rely on stdout: the line reaches the
kernel through a pipe, too late to determine which node logged it.  So an environment variable that
ROS reads once sets a log format with marks around each line.  The kernel drops marked lines of
Python code, because they were shown when they were logged.  Lines that only C code wrote lose
their marks and go to the running cell.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
import io
import os
from typing import Any

import rclpy.context
import rclpy.logging

_BEGIN, _NEXT, _END = '\x1e', '\x1f', '\x1d\n'  # ASCII separators, which no log text contains
_VARIABLES = {
    'RCUTILS_LOGGING_USE_STDOUT': '1',
    'RCUTILS_COLORIZED_OUTPUT': '0',
    'RCUTILS_CONSOLE_OUTPUT_FORMAT': f'{_BEGIN}{{file_name}}{_NEXT}{{severity}}{_NEXT}{{name}}'
    f'{_NEXT}{{message}}{_END[0]}',
}
MARK = f'{_BEGIN}{_NEXT}{_NEXT}{_NEXT}{_END}'.encode()
"""A marked line without a node: when it arrives, all earlier output has been read."""
_C_FILES = ('.c', '.cc', '.cpp', '.cxx', '.h', '.hpp')
# Colours of the level name and its background.  ROS colours the whole line, but no shade of
# yellow is readable on both a white and a black page.
_COLOURS = {
    'DEBUG': '38;5;231;48;5;240',
    'WARN': '38;5;16;48;5;220',
    'ERROR': '38;5;231;48;5;160',
    'FATAL': '38;5;231;48;5;160',
}


def log_text(level: str, logger: str, message: str) -> str:
    """Return a log line as notebooks show it, with its level on a coloured background."""
    word, rest = f'[{level}]', f' [{logger}]: {message}'
    colour = _COLOURS.get(level)
    if colour is None or os.environ.get('RCUTILS_COLORIZED_OUTPUT') == '0':
        return word + rest
    return f'\x1b[{colour}m{word}\x1b[0m{rest}'


def mark_console() -> bool:
    """Make ROS put marks around each console line; False if its log outputs are set up already."""
    if rclpy.context.g_logging_ref_count:
        return False
    with _variables(_VARIABLES):
        rclpy.logging.shutdown()
        rclpy.logging.initialize()
    return True


def stop_terminal_copies(stream: Any) -> None:
    """
    Stop the kernel from copying the output of C code to the terminal of the Jupyter server.

    :param stream: the kernel's stdout; its file descriptor is the terminal, not the notebook
    """
    with suppress(io.UnsupportedOperation):
        terminal = stream.fileno()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, terminal)
        os.close(nowhere)


class ConsoleLines:
    """Removes marked lines of Python code, and the marks of other lines, from pieces of text."""

    def __init__(self) -> None:
        self._rest = ''
        self.marks = 0
        """Number of times that :data:`MARK` was read."""

    def feed(self, text: str) -> str:
        """Add a piece of text, and return the text that should be shown now."""
        shown, self._rest = [], self._rest + text
        while self._rest:
            plain, begin, framed = self._rest.partition(_BEGIN)
            shown.append(plain)
            line, end, after = framed.partition(_END)
            if not end:
                self._rest = begin + framed
                break
            self.marks += line == _NEXT * 3
            shown.append(_shown(line))
            self._rest = after
        return ''.join(shown)


def _shown(line: str) -> str:
    place, level, logger, message = (line.split(_NEXT, 3) + [''] * 4)[:4]
    return f'{log_text(level, logger, message)}\n' if place.endswith(_C_FILES) else ''


@contextmanager
def _variables(changed: Mapping[str, str]) -> Iterator[None]:
    """Set environment variables temporarily; child processes must not inherit the marks."""
    before = {name: os.environ.get(name) for name in changed}
    os.environ.update(changed)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
