"""
Run the small Python programs of a message build in forks of a process with their imports loaded.

A message build starts ten such programs: colcon, readers of ``package.xml``, code generators and
``setup.py``.  Each works for a tenth of a second, and its imports take longer.  This process
imports their modules once and runs each program in a fork.  CMake uses ``hand_over.py`` as its
Python, which sends the requests.
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

import hand_over  # type: ignore[import-not-found]  # next to this file, inside the sandbox

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
MAX_BYTES = 1 << 18  # length of a request, which contains a command line and an environment


def import_colcon() -> None:
    """Import colcon with all its plug-ins, and set the path of CMake."""
    with contextlib.suppress(ImportError):
        from cmake import CMAKE_BIN_DIR  # type: ignore[import-not-found]

        # The command of PyPI's cmake is a slow Python wrapper, so name the real program. Colcon
        # reads the variable only once, when it is imported.
        os.environ['CMAKE_COMMAND'] = str(Path(CMAKE_BIN_DIR) / 'cmake')
    for point in (point for found in distributions() for point in found.entry_points):
        if point.group.startswith(PLUGINS):
            # Colcon itself reports a broken plug-in, and works without it.
            with contextlib.suppress(Exception):
                point.load()


def listen(folder: Path) -> tuple[socket.socket | None, dict[str, str]]:
    """
    Open the socket for requests to run programs.

    :param folder: in which the socket is created
    :returns: the socket, and the environment variable with its path for the build; None and no
        variable if sockets are forbidden or the path is too long for a socket
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

    :param listening: the socket for requests; None serves none
    :returns: the program's exit code; 1 if a signal ended it
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
    """Run a program and return the exit code that ``python`` would return."""
    said: object = 1
    try:
        gc.disable()  # the program is short, and a collection would copy the shared memory pages
        said = program()
    except SystemExit as ended:
        said = ended.code
    except BaseException:  # noqa: BLE001 - like Python, print any exception and exit
        sys.excepthook(*sys.exc_info())
    if said is not None and not isinstance(said, int):
        print(said, file=sys.stderr)
        said = 1
    with contextlib.suppress(OSError, ValueError):
        sys.stdout.flush()
        sys.stderr.flush()
    return (said or 0) & 0xFF


def _serve(listening: socket.socket) -> None:
    """Run the requested programs, each in a fork of this process, until this process is killed."""
    for name in IMPORTS:  # this takes about as long as the build needs before its first request
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    with contextlib.suppress(ImportError):
        from rosidl_parser import parser  # type: ignore[import-untyped]

        parser.get_ast_from_idl_string(TRIAL)  # the first call compiles the grammar
    while True:
        client, _ = listening.accept()
        _fork(partial(_answer, client))
        client.close()
        # Reaping adds the forks' processor time to this process; with SIG_IGN it would be lost.
        with contextlib.suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG) != (0, 0):
                pass


def _answer(client: socket.socket) -> None:
    """Run a requested program and send its exit code; if the program is killed, send nothing."""
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
    Run a program in this process as ``python`` would.

    :param words: the command line without the interpreter
    :param env: all variables of its environment
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
