"""
Keep processes that have rclpy loaded, and fork them to create the probe and the program of a run.

:mod:`autograder.inside.forks` runs in these processes.  Each serves one run at a time; runs in
parallel start further servers, which later runs reuse.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from functools import partial
import json
import os
from pathlib import Path
import select
import socket
import struct
import subprocess
from typing import Any, BinaryIO
import weakref

from autograder.clock.virtual_clock import clock_programs
from autograder.errors import ProbeFailed, SandboxUnavailable
from autograder.sandboxes import sandbox as sandboxes
from autograder.sandboxes.confinement import end_group, Limits, Program
from autograder.sandboxes.isolation import fix_for
from autograder.sandboxes.sandbox import Sandbox

BORN = b'born'
CREDENTIALS = struct.Struct('3i')  # process, user and group id of a sender: unix(7)
ANSWER_BYTES = 64
ANSWER_S = 120.0  # timeout, two hundred times the usual duration
ENTER = 'CAP_SYS_ADMIN'  # capability to enter the network of a run: setns(2)


@dataclass(frozen=True)
class Loaded:
    """
    A program that loads rclpy and then forks on request.

    :param program: its command without arguments, and the files that it needs
    :param boxed: whether the program has its own file systems, network and process ids; its forks
        then enter only the network of a run
    """

    program: Program
    boxed: bool


@dataclass(frozen=True)
class Fork:
    """
    A process of one run.

    :param server: the server that forked the process and reports its exit code
    :param gate: the grader's end of the process's standard input
    """

    server: ForkServer
    pid: int
    gate: socket.socket
    stdout: BinaryIO
    stderr: BinaryIO


class ForkServer:
    """A process that forks others, one at a time; its sandbox confines them and, if boxed, it."""

    def __init__(self, sandbox: Sandbox, loaded: Loaded) -> None:
        """Start the process, and wait until it has imported rclpy."""
        self.sandbox, self.loaded = sandbox, loaded
        self.channel, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self.process = self._start(theirs)
        weakref.finalize(self, _end, self.process, self.channel)
        self.channel.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        self.channel.settimeout(ANSWER_S)
        try:
            self._answer()
        except ProbeFailed as error:
            end_group(self.process)
            said = self.process.communicate()[1].decode(errors='replace').strip().splitlines()
            what = (said or ['no error message'])[-1]
            raise SandboxUnavailable(
                f'The fork server did not start: {what}.', fix_for(what)
            ) from error

    def _start(self, channel: socket.socket) -> subprocess.Popen[bytes]:
        pipes: dict[str, Any] = {'stdin': channel, 'stdout': subprocess.DEVNULL}
        variables = {**self.loaded.program.variables, 'LD_PRELOAD': clock_programs()[1]}
        program = replace(self.loaded.program, variables=variables)
        if self.loaded.boxed:
            options = self.sandbox.bwrap(program, Limits(), (), [ENTER])
            options += ['--remount-ro', '/tmp', '--remount-ro', '/dev/shm']
            return sandboxes.start_bwrap(options, program.argv, (), **pipes)
        argv, variables = self.sandbox.host_command(program, Path(sandboxes.HOME), 0)
        del variables['TMPDIR']  # a program in namespaces has its own /tmp
        return subprocess.Popen(argv, env=variables, cwd='/', **{**sandboxes.PIPES, **pipes})

    def usable(self, sandbox: Sandbox) -> bool:
        """Return whether the process is alive and was started for an equal sandbox."""
        if (self.sandbox.mode, self.sandbox.ros) != (sandbox.mode, sandbox.ros):
            return False
        # An idle server sends nothing, so the channel is readable only if the server has ended.
        return self.process.poll() is None and not select.select([self.channel], [], [], 0)[0]

    def fork(self, order: Mapping[str, Any], others: Sequence[int]) -> Fork:
        """
        Fork a process, which has not yet read from its standard input.

        :param order: described in :mod:`autograder.inside.forks`
        :param others: descriptors to send with the order, after those of standard input and output
        :raises ProbeFailed: if the fork could not confine itself, or the server has ended
        """
        with ExitStack() as on_failure, ExitStack() as theirs:
            gate, given = socket.socketpair()
            on_failure.callback(gate.close)
            theirs.callback(given.close)
            files, outputs = [given.fileno()], []
            for reading, writing in (os.pipe(), os.pipe()):
                outputs.append(on_failure.enter_context(os.fdopen(reading, 'rb')))
                theirs.callback(os.close, writing)
                files.append(writing)
            try:
                socket.send_fds(self.channel, [json.dumps(order).encode()], [*files, *others])
            except OSError as error:
                raise ProbeFailed(f'The fork server has ended: {error}.') from error
            theirs.close()
            said, pid = self._answer()
            if said != BORN:
                why = outputs[1].read().decode(errors='replace').strip() or 'no error message'
                raise ProbeFailed(f'A fork could not be confined: {why}.')
            on_failure.pop_all()
        return Fork(self, pid, gate, *outputs)

    def ended(self) -> int | None:
        """Wait for the exit code of the last fork, and free the server; None if it has failed."""
        try:
            code = int(self._answer()[0])
        except ProbeFailed:
            return None
        self.give_back()
        return code

    def give_back(self) -> None:
        """Mark the server as idle."""
        _idle.append(self)

    def _answer(self) -> tuple[bytes, int]:
        """Receive one message, and return it with its sender's process id."""
        space = socket.CMSG_SPACE(CREDENTIALS.size)
        try:
            said, more, _, _ = self.channel.recvmsg(ANSWER_BYTES, space)
        except OSError as error:
            raise ProbeFailed(f'The fork server does not answer: {error}.') from error
        pids = [
            CREDENTIALS.unpack(data)[0] for _, kind, data in more if kind == socket.SCM_CREDENTIALS
        ]
        if not said or not pids:
            raise ProbeFailed('The fork server has ended.')
        return said, pids[0]


def _end(process: subprocess.Popen[bytes], channel: socket.socket) -> None:
    channel.close()
    if process.poll() is None:
        end_group(process)
        process.wait()
    if process.stderr:
        process.stderr.close()


_idle: list[ForkServer] = []
# The kernel ends a sandbox when the thread that started it ends. This pool's threads never end.
_starters = ThreadPoolExecutor(thread_name_prefix='fork servers')


def free_servers(sandbox: Sandbox, *all_loaded: Loaded) -> list[ForkServer]:
    """
    Return an idle fork server or a new one for each program.

    New servers start in parallel, because each takes a third of a second.

    :raises SandboxUnavailable: if a new server does not start
    """
    return list(_starters.map(partial(_free_server, sandbox), all_loaded))


def _free_server(sandbox: Sandbox, loaded: Loaded) -> ForkServer:
    """Take an idle server from the list or start one; drop idle servers that have ended."""
    for server in reversed(_idle.copy()):  # the last one's pages are most likely still cached
        if server.loaded == loaded:
            with suppress(ValueError):  # another thread has taken it
                _idle.remove(server)
                if server.usable(sandbox):
                    return server
    return ForkServer(sandbox, loaded)
