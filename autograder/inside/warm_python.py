"""
Run the small Python programs of a message build in copies of a process that has all they import.

A message package starts ten of them: colcon, the readers of ``package.xml``, the generators of
code, ``setup.py``.  Each needs a tenth of a second for its work and more for its imports.  Here a
process imports once, and each program is run by a fork of it.
``hand_over.py`` is the other side, which CMake takes for Python.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
import contextlib
from functools import partial
import gc
import importlib
from importlib.metadata import distributions
import os
from pathlib import Path
import runpy
import select
import signal
import socket
import sys
from typing import Any, NoReturn

import hand_over  # type: ignore[import-not-found]  # beside this file, inside the sandbox
import parse_once  # type: ignore[import-not-found]

IMPORTS = (
    'catkin_pkg.package',
    'ament_package.templates',
    'rosidl_adapter.cli',
    'rosidl_generator_type_description',
    'rosidl_generator_c',
    'rosidl_generator_py.generate_py_impl',
    'rosidl_typesupport_c',
    'rosidl_typesupport_fastrtps_c',
    'rosidl_typesupport_introspection_c',
    'setuptools.command.egg_info',
    'compileall',
)
PLUGINS = 'colcon_core.'
TRIAL = 'module trial { struct Trial { long number; }; };'
MOST_BYTES = 1 << 18  # of a request: its command line and environment


def import_colcon() -> None:
    """Import colcon with all its plugins, and have it find CMake."""
    with contextlib.suppress(ImportError):
        from cmake import CMAKE_BIN_DIR  # type: ignore[import-not-found]

        # PyPI's cmake is a Python program that starts CMake. Colcon looks once, when it is loaded.
        os.environ['CMAKE_COMMAND'] = str(Path(CMAKE_BIN_DIR) / 'cmake')
    for point in (point for found in distributions() for point in found.entry_points):
        if point.group.startswith(PLUGINS):
            # Colcon itself says what is wrong with a plugin, and does without.
            with contextlib.suppress(Exception):
                point.load()


def _import_all(folder: Path) -> None:
    """
    Import what the programs need; what is not there is left to the one that needs it.

    :param folder: where the copies write down what they parse
    """
    for name in IMPORTS:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    with contextlib.suppress(ImportError):
        from rosidl_parser import parser  # type: ignore[import-untyped]

        parse = parser.get_ast_from_idl_string
        parse(TRIAL)  # the grammar is compiled with the first text
        parser.get_ast_from_idl_string = parse_once.parse_once(parse, folder)


def listen(folder: Path) -> tuple[socket.socket | None, dict[str, str]]:
    """
    Listen for programs to run.

    :param folder: for the socket
    :returns: the socket, and the variable that tells a build of it; nothing where there can be
        none: where sockets are forbidden, or the folder's path is too long for one
    """
    path = str(folder / 'warm')
    try:
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        listening.bind(path)
        listening.listen()
    except OSError:
        return None, {}
    return listening, {hand_over.SOCKET: path}


def run_beside(
    program: Callable[[], object], listening: socket.socket | None, folder: Path
) -> int:
    """
    Run a program and, until it ends, those that are handed over.

    :param folder: an existing one for what is parsed
    :returns: the program's exit code, 1 if a signal ended it
    """
    first = os.pidfd_open(_fork(program))
    if listening:
        _import_all(folder)  # it takes as long as the program needs to get to the first of them
    waiting: dict[int, socket.socket] = {}
    while True:
        ready: list[Any] = [first, *waiting, *([listening] if listening else ())]
        ready, _, _ = select.select(ready, [], [])
        if first in ready:
            return _ended(first)
        for one in set(ready) & set(waiting):
            with waiting.pop(one) as client, contextlib.suppress(OSError):  # it may be gone
                client.send(bytes([_ended(one)]))
        if listening and listening in ready:
            client, _ = listening.accept()
            waiting[os.pidfd_open(_fork(partial(_asked, client)))] = client


def _fork(program: Callable[[], object]) -> int:
    """Run a program in a copy of this process and return the copy's process id."""
    sys.stdout.flush()
    copy = os.fork()
    if copy == 0:
        _be(program)
    return copy


def _ended(copy: int) -> int:
    """Return the exit code of a copy that has ended, 1 if a signal ended it."""
    told = os.waitid(os.P_PIDFD, copy, os.WEXITED)
    os.close(copy)
    return told.si_status if told and told.si_code == os.CLD_EXITED else 1


def _be(program: Callable[[], object]) -> NoReturn:
    """Become a program, which ends as ``python`` would end with it."""
    code = 1
    try:
        gc.disable()  # it would end before it is worth it, and copy what is shared
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = _exit_code(program())
    except SystemExit as ended:
        code = _exit_code(ended.code)
    except BaseException:  # as Python itself does with what nobody catches
        sys.excepthook(*sys.exc_info())
    finally:
        with contextlib.suppress(OSError, ValueError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _exit_code(said: object) -> int:
    if said is None or isinstance(said, int):
        return (said or 0) & 0xFF
    print(said, file=sys.stderr)
    return 1


def _asked(client: socket.socket) -> None:
    """Run what a client asks for."""
    text, descriptors, _, _ = socket.recv_fds(client, MOST_BYTES, 3)
    client.close()
    if not text:
        return  # the client ended before it sent a request
    for number, descriptor in enumerate(descriptors):
        os.dup2(descriptor, number)
        os.close(descriptor)
    count, *fields = os.fsdecode(text).split('\0')
    words, folder, *environment = fields[: int(count)], *fields[int(count) :]
    os.chdir(folder)
    become(words, dict(entry.split('=', 1) for entry in environment))


def become(words: list[str], env: Mapping[str, str]) -> None:
    """
    Run a program in this process as ``python`` runs it.

    :param words: the command line without the interpreter
    """
    os.environ.clear()
    os.environ.update(env)
    if words[0] == '-m':
        sys.argv = words[1:]
        runpy.run_module(words[1], run_name='__main__', alter_sys=True)
    else:
        sys.argv = words
        sys.path[0] = str(Path(words[0]).resolve().parent)
        runpy.run_path(words[0], run_name='__main__')
