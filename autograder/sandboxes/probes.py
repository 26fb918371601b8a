"""
Create a run's probe in the network of the student's sandbox, separate from the student's program.

A probe is a fork of a process that has rclpy loaded, see :mod:`autograder.probe.fork_server`.  As
root, this process has its own sandbox.  A plain user's probe enters the user namespace of the
student's sandbox, in which no further namespace can be created.  There, Landlock confines the
probe if the kernel supports it; otherwise, only limits and the system-call filter confine it.
Without isolation, the probe runs unconfined next to the student's program.
"""

from __future__ import annotations

from collections.abc import Sequence
import compileall
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache
import json
import os
from pathlib import Path
import select
import signal
import socket
import struct
import subprocess
from typing import Any
import weakref

from autograder.clock.virtual_clock import built
from autograder.errors import ProbeFailed, SandboxUnavailable
from autograder.sandboxes import landlock
from autograder.sandboxes import sandbox as sandboxes
from autograder.sandboxes.confined import Confined, end_group, Limits, Program
from autograder.sandboxes.isolation import fix_for
from autograder.sandboxes.processes import first_port
from autograder.sandboxes.sandbox import HERE, Sandbox

CODE = {str(HERE / name): f'/grader/{name}' for name in ('probe', 'inside')}
"""Folders of the grader that the fork server can read; ``inside`` is shared with the student."""
START = '/grader/probe/fork_server.py'
FILTER = '/grader/filter.bpf'
LIMITS = Limits()
ENTER = 'CAP_SYS_ADMIN'  # capability to enter the network of a run: setns(2)
BORN = b'born'
CREDENTIALS = struct.Struct('3i')  # process, user and group id of a sender: unix(7)
ANSWER_BYTES = 64
ANSWER_S = 120.0  # timeout, two hundred times the usual duration


@cache
def compile_code() -> None:
    """Compile the files that each run starts; in a sandbox, Python cannot write bytecode."""
    for folder in CODE:
        compileall.compile_dir(folder, quiet=2)  # ignores folders that are not writable


class Probe:
    """
    The probe of one run.

    :param server: the process that forked the probe, and reports its exit code
    :param pid: host process id
    :param pipes: descriptors of the probe's standard input, output and error
    """

    def __init__(self, server: ForkServer, pid: int, pipes: Sequence[int]) -> None:
        """Open the pipes, which are closed by :meth:`end`."""
        self.server, self.pid = server, pid
        self.pidfd = os.pidfd_open(pid)
        self.stdin = os.fdopen(pipes[0], 'wb')
        self.stdout, self.stderr = (os.fdopen(pipe, 'rb') for pipe in pipes[1:])
        self.returncode: int | None = None

    def kill(self) -> None:
        """Kill the probe if it is still running."""
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)

    def end(self) -> str:
        """Kill the probe, read its exit code, and return the last line of its standard error."""
        self.kill()
        said = self.stderr.read().decode(errors='replace').strip()
        self.returncode = self.server.ended()
        os.close(self.pidfd)
        with suppress(BrokenPipeError):
            self.stdin.close()
        self.stdout.close()
        self.stderr.close()
        return (said.splitlines() or [''])[-1]


class ForkServer:
    """
    A process that forks probes, one at a time.

    :param sandbox: confines the process and its probes
    """

    def __init__(self, sandbox: Sandbox) -> None:
        """
        Start the process, and wait until it has imported rclpy.

        :raises SandboxUnavailable: if the process does not start
        """
        self.sandbox = sandbox
        self.boxed = sandbox.facts.namespaces and sandbox.facts.root
        binds = {**CODE, str(landlock.filter_file()): FILTER}
        variables = {'LD_PRELOAD': built()[1]}
        self.program = Program((sandbox.ros.python, START), binds, variables=variables)
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
            what = self.process.communicate()[1].decode(errors='replace').strip() or 'no word'
            raise SandboxUnavailable(
                f'The fork server of the probes did not start: {what}.', fix_for(what)
            ) from error

    def _start(self, channel: socket.socket) -> subprocess.Popen[bytes]:
        pipes: dict[str, Any] = {'stdin': channel, 'stdout': subprocess.DEVNULL}
        if self.boxed:
            options = self.sandbox.bwrap(self.program, LIMITS, (), [ENTER])
            options += ['--remount-ro', '/tmp', '--remount-ro', '/dev/shm']
            return sandboxes.start_bwrap(options, self.program.argv, (), **pipes)
        argv, variables = self.sandbox.outside(self.program, Path('/'), 0)
        return subprocess.Popen(argv, env=variables, cwd='/', **{**sandboxes.PIPES, **pipes})

    def usable(self, sandbox: Sandbox) -> bool:
        """Return whether the process is alive and was started for an equal sandbox."""
        if (self.sandbox.mode, self.sandbox.ros) != (sandbox.mode, sandbox.ros):
            return False
        # An idle server sends nothing, so the channel is readable only if the server has ended.
        return self.process.poll() is None and not select.select([self.channel], [], [], 0)[0]

    def make(self, student: Confined, place: int) -> Probe:
        """
        Fork a probe, which waits for its scenario.

        :param student: the program, which has not been released yet
        :param place: the probe's socket for the virtual clock, a descriptor
        :raises ProbeFailed: if the probe could not confine itself, or has ended
        """
        pipes = [os.pipe() for _ in range(3)]
        (given, giving), *written = pipes
        ours = [giving, *(reading for reading, _ in written)]
        theirs = [given, *(writing for _, writing in written)]
        # Enter the user namespace first, which gives the right to enter the network namespace.
        namespaces = [fd for _, fd in sorted(student.namespaces.items(), reverse=True)]
        try:
            self._order(student, theirs, [place, *namespaces])
            said, pid = self._answer()
            if said == BORN:
                return Probe(self, pid, ours)
            with os.fdopen(os.dup(ours[2]), 'rb') as errors:
                why = errors.read().decode(errors='replace').strip() or 'no word'
            raise ProbeFailed(f'The probe could not be confined: {why}.')
        except BaseException:
            for pipe in ours:
                os.close(pipe)
            raise

    def _order(self, student: Confined, pipes: Sequence[int], others: Sequence[int]) -> None:
        """
        Send the order for a probe, with its ends of the pipes, which are closed here.

        :raises ProbeFailed: if the server has ended
        """
        folder, domain = Path('/grader') if self.boxed else HERE, student.domain
        order = {
            'variables': {
                'ROS_DOMAIN_ID': str(domain),
                'FASTRTPS_DEFAULT_PROFILES_FILE': str(folder / 'probe' / 'probe.xml'),
                'UNICAST_PORT': str(first_port(domain)),
            },
            'limits': LIMITS.of_process(self.sandbox.processes()),
            'rules': self._rules(),
        }
        try:
            socket.send_fds(self.channel, [json.dumps(order).encode()], [*pipes, *others])
        except OSError as error:
            raise ProbeFailed(f'The fork server of the probes has ended: {error}.') from error
        finally:
            for pipe in pipes:
                os.close(pipe)

    def _rules(self) -> dict[str, Any] | None:
        """Return the rules for :func:`confine.give_up`; None if a probe keeps its rights."""
        if self.boxed:
            return {'uid': sandboxes.throw_away_uid(), 'filter': FILTER}
        if not self.sandbox.keeps_secrets:
            return None
        rules = self.sandbox.landlock_rules(self.program)
        if landlock.refusal(root=os.geteuid() == 0)[0]:
            rules = {name: rules[name] for name in ('uid', 'filter')}
        return rules

    def ended(self) -> int | None:
        """
        Wait for the exit code of the last probe and return it; None if the server has failed.

        After a known exit code, the server is marked as idle, ready for the next probe.
        """
        try:
            code = int(self._answer()[0])
        except ProbeFailed:
            return None
        _idle.append(self)
        return code

    def _answer(self) -> tuple[bytes, int]:
        """
        Receive one message, and return it with the process id of its sender.

        :raises ProbeFailed: if no message arrives within 120 s, or the server has ended
        """
        space = socket.CMSG_SPACE(CREDENTIALS.size)
        try:
            said, more, _, _ = self.channel.recvmsg(ANSWER_BYTES, space)
        except OSError as error:
            what = f'The fork server of the probes does not answer: {error}.'
            raise ProbeFailed(what) from error
        pids = [
            CREDENTIALS.unpack(data)[0] for _, kind, data in more if kind == socket.SCM_CREDENTIALS
        ]
        if not said or not pids:
            raise ProbeFailed('The fork server of the probes has ended.')
        return said, pids[0]


def _end(process: subprocess.Popen[bytes], channel: socket.socket) -> None:
    channel.close()
    if process.poll() is None:
        end_group(process)
        process.wait()
    if process.stderr:
        process.stderr.close()


_idle: list[ForkServer] = []
# The kernel ends a sandbox when the thread that started it ends. These threads never end.
_starters = ThreadPoolExecutor(thread_name_prefix='fork servers')


def start_probe(sandbox: Sandbox, student: Confined, place: int) -> Probe:
    """
    Start a probe, which waits for its scenario.

    :param student: the program, which has not been released yet
    :param place: the probe's socket for the virtual clock, a descriptor
    :raises ProbeFailed: if the probe cannot be started
    :raises SandboxUnavailable: if the fork server does not start
    """
    return _free_server(sandbox).make(student, place)


def _free_server(sandbox: Sandbox) -> ForkServer:
    """Return an idle fork server or a new one; unusable servers are dropped, which ends them."""
    with suppress(IndexError):  # no server is idle
        while True:
            server = _idle.pop()
            if server.usable(sandbox):
                return server
    return _starters.submit(ForkServer, sandbox).result()
