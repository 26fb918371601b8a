"""
Run the small Python programs of a message build in forks of a process with their imports.

A message build starts ten of them: colcon, the readers of ``package.xml``, the generators of code,
``setup.py``.  Each needs a tenth of a second for its work and more for its imports.  This process
imports once and runs each program in a fork.  ``hand_over.py`` is the other side, which CMake uses
as Python.
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
import signal
import socket
import sys

import hand_over  # type: ignore[import-not-found]  # beside this file, inside the sandbox

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
MAX_BYTES = 1 << 18  # of a request: its command line and environment


def import_colcon() -> None:
    """Import colcon with all its plug-ins, and let it find CMake."""
    with contextlib.suppress(ImportError):
        from cmake import CMAKE_BIN_DIR  # type: ignore[import-not-found]

        # PyPI's cmake is a Python program that starts CMake. Colcon looks once, when it is loaded.
        os.environ['CMAKE_COMMAND'] = str(Path(CMAKE_BIN_DIR) / 'cmake')
    for point in (point for found in distributions() for point in found.entry_points):
        if point.group.startswith(PLUGINS):
            # Colcon itself says what is wrong with a plugin, and does without.
            with contextlib.suppress(Exception):
                point.load()


def listen(folder: Path) -> tuple[socket.socket | None, dict[str, str]]:
    """
    Listen for requests to run programs.

    :param folder: for the socket
    :returns: the socket, and the variable that names it for a build; nothing if sockets are
        forbidden or the folder's path is too long for one
    """
    path = str(folder / 'warm')
    try:
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        listening.bind(path)
        listening.listen()
    except OSError:
        return None, {}
    return listening, {hand_over.SOCKET: path}


def run_beside(program: Callable[[], object], listening: socket.socket | None) -> int:
    """
    Run a program and, until it ends, serve the requests of ``hand_over.py``.

    :returns: the program's exit code, 1 if a signal ended it
    """
    first = _fork(program)
    server = _fork(partial(_serve, listening)) if listening else None
    _, status = os.waitpid(first, 0)
    if server:
        os.kill(server, signal.SIGKILL)
        os.waitpid(server, 0)
    return os.WEXITSTATUS(status) if os.WIFEXITED(status) else 1


def _fork(program: Callable[[], object]) -> int:
    """Run a program in a fork of this process and return the fork's process id."""
    sys.stdout.flush()
    copy = os.fork()
    if copy == 0:
        code = 1
        try:
            code = _code_of(program)
        finally:
            os._exit(code)
    return copy


def _code_of(program: Callable[[], object]) -> int:
    """Run a program and return the exit code with which ``python`` would end."""
    said: object = 1
    try:
        gc.disable()  # the program ends before it is worth it, and it would copy what is shared
        said = program()
    except SystemExit as ended:
        said = ended.code
    except BaseException:  # noqa: BLE001 - as Python itself ends
        sys.excepthook(*sys.exc_info())
    if said is not None and not isinstance(said, int):
        print(said, file=sys.stderr)
        said = 1
    with contextlib.suppress(OSError, ValueError):
        sys.stdout.flush()
        sys.stderr.flush()
    return (said or 0) & 0xFF


def _serve(listening: socket.socket) -> None:
    """Run the requested programs, each in a fork of this process, until it is stopped."""
    for name in IMPORTS:  # it takes as long as the build needs to get to the first of them
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    with contextlib.suppress(ImportError):
        from rosidl_parser import parser  # type: ignore[import-untyped]

        parser.get_ast_from_idl_string(TRIAL)  # the grammar is compiled with the first text
    while True:
        client, _ = listening.accept()
        _fork(partial(_answer, client))
        client.close()
        # Their processor time then counts as that of this process. SIG_IGN would lose it.
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG) != (0, 0):
                pass


def _answer(client: socket.socket) -> None:
    """Run a requested program and send its exit code; the socket closes if it is killed."""
    text, descriptors, _, _ = socket.recv_fds(client, MAX_BYTES, 3)
    if not text:
        return  # the client ended before it sent a request
    for number, descriptor in enumerate(descriptors):
        os.dup2(descriptor, number)
        os.close(descriptor)
    count, *fields = os.fsdecode(text).split('\0')
    words, folder, *environment = fields[: int(count)], *fields[int(count) :]
    os.chdir(folder)
    code = _code_of(partial(become, words, dict(entry.split('=', 1) for entry in environment)))
    with contextlib.suppress(OSError):  # the client may be gone
        client.send(bytes([code]))


def become(words: list[str], env: Mapping[str, str]) -> None:
    """
    Run a program in this process as ``python`` runs it.

    :param words: the command line without the interpreter
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.environ.clear()
    os.environ.update(env)
    if words[0] == '-m':
        sys.argv = words[1:]
        runpy.run_module(words[1], run_name='__main__', alter_sys=True)
    else:
        sys.argv = words
        sys.path[0] = str(Path(words[0]).resolve().parent)
        runpy.run_path(words[0], run_name='__main__')
