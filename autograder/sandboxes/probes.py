"""
Make a run's probe in the network of the student's sandbox, apart from the student.

A probe is a fork of a process that has rclpy loaded, see :mod:`autograder.probe.fork_server`.  As
root, this process is in a sandbox of its own.  A plain user's probe joins the user namespace of
the student's sandbox, in which no further namespace can be made.  There, Landlock confines the
probe if the kernel has it; if not, limits, the system-call filter and a bare environment are its
only confinement.  Without isolation, the probe runs next to the student's program.
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
from typing import Any, NoReturn
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
"""Folders that the fork server sees; of the second, it shares files with the student's side."""
START = '/grader/probe/fork_server.py'
FILTER = '/grader/filter.bpf'
LIMITS = Limits()
ENTER = 'CAP_SYS_ADMIN'  # the network of a run: setns(2)
BORN = b'born'
CREDENTIALS = struct.Struct('3i')  # process, user and group id of a sender: unix(7)
ANSWER_BYTES = 64
ANSWER_S = 120.0  # two hundred times what it takes


@cache
def compile_code() -> None:
    """Keep bytecode beside what each run starts: inside a sandbox Python can keep none."""
    for folder in CODE:
        compileall.compile_dir(folder, quiet=2)  # not if it may not write there


class Probe:
    """
    The probe of one run.

    :param server: made it, and says how it ended
    :param pid: host process id
    :param pipes: descriptors for its scenario, its events and its last words
    """

    def __init__(self, server: ForkServer, pid: int, pipes: Sequence[int]) -> None:
        """Take the pipes."""
        self.server, self.pid = server, pid
        self.pidfd = os.pidfd_open(pid)
        self.stdin = os.fdopen(pipes[0], 'wb')
        self.stdout, self.stderr = (os.fdopen(pipe, 'rb') for pipe in pipes[1:])
        self.returncode: int | None = None

    def kill(self) -> None:
        """End it."""
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)

    def end(self) -> str:
        """End the probe and return its last output."""
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
    A process that makes probes, one at a time.

    :param sandbox: how it is confined
    """

    def __init__(self, sandbox: Sandbox) -> None:
        """
        Start it; it takes as long as Python and rclpy need.

        :raises SandboxUnavailable: if it does not start
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
        except ProbeFailed:
            self._refused()

    def _start(self, channel: socket.socket) -> subprocess.Popen[bytes]:
        pipes: dict[str, Any] = {'stdin': channel, 'stdout': subprocess.DEVNULL}
        if self.boxed:
            options = self.sandbox.bwrap(self.program, LIMITS, (), [ENTER])
            options += ['--remount-ro', '/tmp', '--remount-ro', '/dev/shm']
            return sandboxes.start_bwrap(options, self.program.argv, (), **pipes)
        argv, variables = self.sandbox.outside(self.program, Path('/'), 0)
        return subprocess.Popen(argv, env=variables, cwd='/', **{**sandboxes.PIPES, **pipes})

    def usable(self, sandbox: Sandbox) -> bool:
        """Return whether it is alive and confined in this way."""
        if (self.sandbox.mode, self.sandbox.ros) != (sandbox.mode, sandbox.ros):
            return False
        # It speaks when it is spoken to, so only its end can be read.
        return self.process.poll() is None and not select.select([self.channel], [], [], 0)[0]

    def make(self, student: Confined, place: int) -> Probe:
        """
        Make a probe, which waits for its scenario.

        :param student: the held program
        :param place: descriptor of the probe's place on the virtual clock
        :raises ProbeFailed: if it could not confine itself, or did not live
        """
        pipes = [os.pipe() for _ in range(3)]
        (given, giving), *written = pipes
        ours = [giving, *(reading for reading, _ in written)]
        theirs = [given, *(writing for _, writing in written)]
        # A user namespace first: it gives the right to enter the other.
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
        """Order a probe, which takes over the ends of its pipes."""
        order = {
            'variables': self._variables(student.domain),
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
        """Return the rules of a probe, None if it keeps its rights."""
        if self.boxed:
            return {'uid': sandboxes.throw_away_uid(), 'filter': FILTER}
        if not self.sandbox.keeps_secrets:
            return None
        rules = self.sandbox.landlock_rules(self.program)
        if landlock.refusal(root=os.geteuid() == 0)[0]:
            rules = {name: rules[name] for name in ('uid', 'filter')}
        return rules

    def _variables(self, domain: int) -> dict[str, str]:
        """Return the variables that depend on the run: its domain, the profile and its port."""
        folder = Path('/grader') if self.boxed else HERE
        return {
            'ROS_DOMAIN_ID': str(domain),
            'FASTRTPS_DEFAULT_PROFILES_FILE': str(folder / 'probe' / 'probe.xml'),
            'UNICAST_PORT': str(first_port(domain)),
        }

    def ended(self) -> int | None:
        """
        Return the exit code of the probe that was made last, None if it is not known.

        If it is known, the server can make the next probe.
        """
        try:
            code = int(self._answer()[0])
        except ProbeFailed:
            return None
        _idle.append(self)
        return code

    def _answer(self) -> tuple[bytes, int]:
        """Return what is said next, and the process id of the sender."""
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

    def _refused(self) -> NoReturn:
        """Say why it did not start."""
        end_group(self.process)
        _, said = self.process.communicate()
        what = said.decode(errors='replace').strip() or 'no word'
        raise SandboxUnavailable(
            f'The fork server of the probes did not start: {what}.', fix_for(what)
        )


def _end(process: subprocess.Popen[bytes], channel: socket.socket) -> None:
    channel.close()
    if process.poll() is None:
        end_group(process)
        process.wait()
    if process.stderr:
        process.stderr.close()


_idle: list[ForkServer] = []
# The kernel ends a sandbox with the thread that started it; these live as long as the process.
_starters = ThreadPoolExecutor(thread_name_prefix='fork servers')


def start_probe(sandbox: Sandbox, student: Confined, place: int) -> Probe:
    """
    Start a probe, which waits for its scenario.

    :param student: the held program
    :param place: descriptor of the probe's place on the virtual clock
    :raises ProbeFailed: if it cannot be started
    :raises SandboxUnavailable: if the sandbox refuses
    """
    return _free_server(sandbox).make(student, place)


def _free_server(sandbox: Sandbox) -> ForkServer:
    """Return an idle fork server, or a new one; one that is not usable is ended."""
    with suppress(IndexError):  # none is idle
        while True:
            server = _idle.pop()
            if server.usable(sandbox):
                return server
    return _starters.submit(ForkServer, sandbox).result()
