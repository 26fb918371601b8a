"""Shorten tracebacks to the learner's own lines, with cells named as the learner sees them."""

import os
from pathlib import Path
import sys
import sysconfig
import traceback

from roslab.output import shell

_MOST_FRAMES = 4
_INSTALLED = ('site-packages', 'dist-packages')
_LIBRARIES = tuple(
    os.path.join(path, '')
    for path in {
        *(sysconfig.get_paths()[name] for name in ('stdlib', 'platstdlib', 'purelib', 'platlib')),
        str(Path(__file__).resolve().parent),
    }
)


def short_traceback(error: BaseException) -> str:
    """Return the learner's lines of a traceback, innermost last, followed by the error."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame for frame in frames if not is_library(frame.filename)]
    lines = []
    for frame in own[-_MOST_FRAMES:]:
        lines.append(f'  {where(frame.filename, frame.lineno)}, in {frame.name}')
        lines += [f'    {frame.line}'] if frame.line else []
    return '\n'.join([*lines, f'  {last_line(error)}'])


def last_line(error: BaseException) -> str:
    """Return the type of an error and the first line of its message."""
    said = str(error).strip().splitlines()
    return f'{type(error).__name__}: {said[0]}' if said else type(error).__name__


def is_library(filename: str) -> bool:
    """Return whether a file belongs to Python, an installed package or roslab."""
    if filename.startswith('<'):
        return True
    # In a sourced installation of ROS, rclpy is outside this interpreter's folders.
    ros = getattr(sys.modules.get('rclpy'), '__file__', None)
    known = (*_LIBRARIES, os.path.join(str(Path(ros).parent), '')) if ros else _LIBRARIES
    if any(part in _INSTALLED for part in Path(filename).parts):  # messages built by colcon
        return True
    return os.path.realpath(filename).startswith(known) or filename.startswith(known)


def code_name(source: str, otherwise: str) -> str:
    """Return the file name for code of the running cell, and ``otherwise`` outside IPython."""
    running = shell()
    cache = getattr(getattr(running, 'compile', None), 'cache', None)
    if running is None or cache is None:
        return otherwise
    # The shell increases its counter before it runs a cell; its history ends with the running
    # cell.
    number = len(getattr(running.history_manager, 'input_hist_raw', ())) - 1
    name: str = cache(source, max(0, number), raw_code=source)
    return name


def where(filename: str, line: int | None) -> str:
    """Return a location as text: a cell by its number, a file by its name."""
    running = shell()
    format_code_name = getattr(getattr(running, 'compile', None), 'format_code_name', None)
    cell = format_code_name(filename) if format_code_name else None
    return f'{" ".join(cell) if cell else Path(filename).name}, line {line}'
