"""
The grader's side of :mod:`autograder.probe.warm_probe`, a process that makes probes.

Each thread that runs submissions has one of its own: the kernel ends a sandbox with the thread
that started it.  A process whose last probe was not seen to end makes no further one.
"""

from __future__ import annotations

from contextlib import suppress
from functools import partial
import json
import os
import select
import signal
import socket
import struct
import subprocess
import threading
from typing import NoReturn
import weakref

from autograder.errors import ProbeFailed, SandboxUnavailable
from autograder.sandboxes import sandbox as sandboxes
from autograder.sandboxes.confined import end_group, Limits, Probe, Program
from autograder.sandboxes.isolation import fix_for, System
from autograder.sandboxes.sandbox import Sandbox

# To join a network, to mount folders and to give all this up: capabilities(7).
CAPABILITIES = ('CAP_SETGID', 'CAP_SETUID', 'CAP_SETPCAP', 'CAP_SYS_ADMIN')
BORN = b'born'
CREDENTIALS = struct.Struct('3i')  # pid, uid and gid of the sender: unix(7)
ANSWER_BYTES = 64
ANSWER_S = 120.0  # on a machine at many times its load; two hundred times what it takes


class WarmProbes:
    """
    A process that makes probes, one at a time.

    :param sandbox: as root
    :param program: that process, and what it and its probes may see
    """

    def __init__(self, sandbox: Sandbox, program: Program, limits: Limits) -> None:
        """Start it; it takes as long as Python and rclpy need."""
        self.ros, self.owner, self.limits = sandbox.ros, os.getpid(), limits
        self.busy = True
        options = sandbox.bwrap(program, limits, (), CAPABILITIES)
        self.channel, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            self.process = sandboxes.start_bwrap(
                options, program.argv, (), stdin=theirs, stdout=subprocess.DEVNULL
            )
        weakref.finalize(self, _end, self.owner, self.process, self.channel)
        self.channel.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        self.channel.settimeout(ANSWER_S)
        try:
            self._answer()
        except ProbeFailed:
            self._refused()
        self.busy = False

    def usable(self, sandbox: Sandbox) -> bool:
        """Tell whether it can make a probe now: it lives, its last one has ended, it is ours."""
        if self.busy or self.owner != os.getpid() or self.ros != sandbox.ros:
            return False
        # It speaks when it is spoken to, so there is nothing to be read but its end.
        return self.process.poll() is None and not select.select([self.channel], [], [], 0)[0]

    def make(self, network: int) -> Probe:
        """
        Make a probe, which waits for its scenario.

        :param network: descriptor of the network to be in
        :raises ProbeFailed: if it could not confine itself, or did not live
        """
        self.busy = True
        pipes = [os.pipe() for _ in range(3)]
        (given, giving), *written = pipes
        stdin = os.fdopen(giving, 'wb')
        stdout, stderr = (os.fdopen(reading, 'rb') for reading, _ in written)
        try:
            self._order([network, given, *(writing for _, writing in written)])
            said, pid = self._answer()
            if said != BORN:
                why = stderr.read().decode(errors='replace').strip()
                raise ProbeFailed(f'The probe could not be confined: {why or "no word"}.')
            held = _open(pid)
        except BaseException:
            for stream in (stdin, stdout, stderr):
                stream.close()
            raise
        # It is the first process of its namespace, which ends with it.
        kill = partial(_kill, held)
        return Probe(pid, stdin, stdout, stderr, kill, partial(self._ended, held))

    def _order(self, files: list[int]) -> None:
        """Order a probe; all descriptors but the first, of the network, are the probe's then."""
        order = {
            'uid': sandboxes.throw_away_uid(),
            'folder': self.limits.folder,
            'limits': self.limits.of_process(),
        }
        try:
            socket.send_fds(self.channel, [json.dumps(order).encode()], files)
        except OSError as error:
            raise ProbeFailed(f'What makes the probes has ended: {error}.') from error
        finally:
            for file in files[1:]:
                os.close(file)

    def _ended(self, held: int) -> int | None:
        os.close(held)
        try:
            code = int(self._answer()[0])
        except ProbeFailed:
            return None
        self.busy = False
        return code

    def _answer(self) -> tuple[bytes, int]:
        """Return what is said next, and the pid of who says it."""
        space = socket.CMSG_SPACE(CREDENTIALS.size)
        try:
            said, more, _, _ = self.channel.recvmsg(ANSWER_BYTES, space)
        except OSError as error:
            raise ProbeFailed(f'What makes the probes does not answer: {error}.') from error
        pids = [
            CREDENTIALS.unpack(data)[0] for _, kind, data in more if kind == socket.SCM_CREDENTIALS
        ]
        if not said or not pids:
            raise ProbeFailed('What makes the probes has ended.')
        return said, pids[0]

    def _refused(self) -> NoReturn:
        """Say why it did not start."""
        end_group(self.process)
        said = b''
        with suppress(subprocess.TimeoutExpired):  # somebody else holds the pipe
            _, said = self.process.communicate(timeout=ANSWER_S)
        what = said.decode(errors='replace').strip() or 'no word'
        raise SandboxUnavailable(
            f'The sandbox of the probes did not start: {what}.', fix_for(what, System.here())
        )


def _open(pid: int) -> int:
    """Return a descriptor of a process that has just said that it is there."""
    try:
        return os.pidfd_open(pid)
    except ProcessLookupError as error:
        raise ProbeFailed('The probe has ended before it was told what to do.') from error


def _kill(held: int) -> None:
    with suppress(ProcessLookupError):
        signal.pidfd_send_signal(held, signal.SIGKILL)


def _end(owner: int, process: subprocess.Popen[bytes], channel: socket.socket) -> None:
    """End the process with its sandbox; in a fork of its owner, only let go of it."""
    channel.close()
    if owner == os.getpid() and process.poll() is None:
        end_group(process)
        process.wait()
    assert process.stderr
    process.stderr.close()


_of_thread = threading.local()


def warm_probes(sandbox: Sandbox, program: Program, limits: Limits) -> WarmProbes:
    """
    Return this thread's process that makes probes; a new one where there is none to be used.

    :raises SandboxUnavailable: if it does not start
    """
    found: WarmProbes | None = getattr(_of_thread, 'probes', None)
    if found is None or not found.usable(sandbox):
        found = _of_thread.probes = WarmProbes(sandbox, program, limits)
    return found
