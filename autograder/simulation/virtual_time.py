"""
Provide a pytest fixture that runs a ROS 2 program on a virtual clock.

Installing the wheel registers the fixture with pytest; ``docs/virtual-time.md`` describes it.
"""

from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
import os
from pathlib import Path
from typing import Any

import pytest

from autograder.commands.check import sandbox_for
from autograder.errors import UsageError
from autograder.simulated import Simulation
from autograder.simulation.documents import order_of, read_simulation
from autograder.simulation.run import record

ENTRY = 'entry_point.py'
ENTRY_TEXT = 'import sys\nfrom {module} import {function}\nsys.exit({function}())\n'


@pytest.fixture
def virtual_time() -> Callable[..., Simulation]:
    """Return :func:`run_program`, which runs a ROS 2 program on a virtual clock."""
    return run_program


def run_program(
    program: str | os.PathLike[str],
    seconds: float,
    *,
    inputs: Mapping[str, Sequence[tuple[float, Any]]] | None = None,
    late: Mapping[str, float] | None = None,
    arguments: Sequence[str] = (),
) -> Simulation:
    """
    Run a program for some virtual time.

    :param program: a Python file, or an entry point such as ``my_package.my_node:main``
    :param seconds: how long to run, from the start of the program [s]; at most a day
    :param inputs: messages to send, as ``{topic: [(second, message), ...]}``; a message is an
        object or a dict of its fields
    :param late: additional subscriptions that join later, as ``{topic: second}``
    :param arguments: arguments of the program, after ``--ros-args``
    :returns: the program's messages and log lines, each with its time
    :raises UsageError: if the file or a topic does not exist, or a time is wrong
    """
    file, files = files_of(program)
    order = order_of(file, seconds, inputs, late, arguments)
    return read_simulation(record(order, files, sandbox_for(visible=True)))


def files_of(program: str | os.PathLike[str]) -> tuple[str, dict[str, str]]:
    """
    Return the name of a program's file, and the contents of all files that the program needs.

    The program can import the modules next to its file by name, and as modules of a package with
    the name of the folder.

    :raises UsageError: if the file or module does not exist
    """
    module, colon, function = str(program).partition(':')
    path = _file_of(module) if colon else Path(program).resolve()
    if not path.is_file():
        raise UsageError(f'{program}: there is no such file.')
    files = {}
    for one in sorted({path, *path.parent.glob('*.py')}):
        text = one.read_text(encoding='utf-8')
        files[one.name] = files[f'{path.parent.name}/{one.name}'] = text
    if not colon:
        return path.name, files
    return ENTRY, {**files, ENTRY: ENTRY_TEXT.format(module=module, function=function)}


def _file_of(module: str) -> Path:
    try:
        spec = find_spec(module)
    except ModuleNotFoundError:
        spec = None
    if spec is None or spec.origin is None:
        raise UsageError(f'{module}: this Python has no such module.')
    return Path(spec.origin)
