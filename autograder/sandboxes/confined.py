"""Describe what to confine, with which limits, and control a program once it runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
import errno
import fcntl
import os
from pathlib import Path
import select
import signal
import socket
import subprocess
import termios

from environment.ros_domain import Claim


@dataclass(frozen=True)
class Limits:
    """
    What one run may use before the grader ends it.

    :param cpu_s: processor seconds, all processes together, and the probe and the clock's driver
    :param memory: bytes of resident memory, all processes together
    :param processes: processes and threads
    :param folder: bytes in each writable folder
    :param inodes: files in the writable folders
    :param output: bytes printed
    """

    cpu_s: int = 20
    memory: int = 1 << 30
    processes: int = 64
    folder: int = 64 << 20
    inodes: int = 20_000
    output: int = 8 << 20

    def of_process(self, others: int = 0) -> dict[str, int]:
        """
        Return the limits that the kernel enforces, by the names of setrlimit(2) in small letters.

        The watchdog enforces limits on sums over processes.

        :param others: processes and threads that the same uid has already: they count
        """
        return {
            'nproc': self.processes + others,
            'as': 2 * self.memory,
            'fsize': self.folder,
            'core': 0,
            'nofile': 256,
            'cpu': self.cpu_s + 5,  # the watchdog, which sums, comes first
        }

    def argv(self, others: int = 0) -> list[str]:
        """Return these limits as the prlimit prefix of a command."""
        limits = self.of_process(others).items()
        return ['prlimit', *(f'--{name}={value}' for name, value in limits), '--']


@dataclass(frozen=True)
class Program:
    """
    What to run and what it may see.

    :param argv: the command, in terms of the sandbox's own paths
    :param binds: read-only, host path to sandbox path
    :param course_messages: whether the course's own built messages are importable
    :param variables: added to the ROS environment
    """

    argv: Sequence[str]
    binds: Mapping[str, str] = field(default_factory=dict)
    course_messages: bool = True
    variables: Mapping[str, str] = field(default_factory=dict)


@dataclass
class Confined:
    """
    A started program and the means to control it.

    :param process: the outermost process
    :param gate: the grader's end of its standard input
    :param pid: host pid of the sandbox's first process, or of the process itself without one
    :param pidfd: descriptor of that process, safe against pid reuse
    :param namespaces: open descriptors ``net`` and, where there is one, ``user``
    :param supervised: whether :mod:`autograder.inside.confine` ends what the program started
    :param home: the folder the program may write to, None where it has a file system of its own
    :param claimed: its ROS domain, None where it has a network of its own
    :param released: whether it was told to go on, and can have heard it
    :param ended_unread: whether it is known to have ended before it heard that; told once
    """

    process: subprocess.Popen[bytes]
    gate: socket.socket
    pid: int
    pidfd: int
    namespaces: dict[str, int] = field(default_factory=dict)
    supervised: bool = False
    home: Path | None = None
    claimed: Claim | None = None
    released: bool = False
    ended_unread: bool = False

    def release(self) -> None:
        """
        Let the program run; until then it waits, see :mod:`autograder.inside.gate`.

        bubblewrap's own ``--block-fd`` would not do: a sandbox that waits there outlives a killed
        grader, and then runs.
        """
        with suppress(OSError):  # it has died already; its exit is noticed elsewhere
            self.gate.send(b'x')
            self.released = True

    def held(self) -> bool:
        """
        Return whether the program still waits, or ended before any line of the student ran.

        The kernel reports this for a socket, and no process inside can write to it: a pipe could
        be opened again through the first process of the sandbox, and filled.
        """
        unread = fcntl.ioctl(self.gate, termios.TIOCOUTQ, bytes(4))
        ended = self.gate.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        self.ended_unread = self.ended_unread or ended == errno.ECONNRESET
        return not self.released or any(unread) or self.ended_unread

    def kill(self) -> None:
        """End everything inside, then the launcher: killed first, that could leave orphans."""
        try:
            if self.supervised:
                # It ends all descendants, daemons too, and then itself.
                signal.pidfd_send_signal(self.pidfd, signal.SIGTERM)
                select.select([self.pidfd], [], [], SUPERVISOR_S)
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)
        except ProcessLookupError:
            pass
        if not self.namespaces and not self.supervised:  # the whole process group
            end_group(self.process)
        self.process.kill()
        self.process.wait()
        for descriptor in (self.pidfd, *self.namespaces.values()):
            os.close(descriptor)
        self.namespaces = {}
        for stream in (self.process.stdout, self.process.stderr):
            if stream is not None:
                stream.close()
        self.gate.close()
        if self.claimed is not None:
            self.claimed.holder.close()

    @property
    def domain(self) -> int:
        """Return the ROS domain id."""
        return self.claimed.domain if self.claimed else 0

    @property
    def enter(self) -> list[str]:
        """Return the command that enters these namespaces; empty if there are none."""
        found = [f'--{kind}=/proc/self/fd/{fd}' for kind, fd in self.namespaces.items()]
        return ['nsenter', *found, '--preserve-credentials', '--'] if found else []

    def files(self) -> tuple[int, int]:
        """Return how many files the program has created and how many bytes they hold."""
        if self.home is not None:
            return _tree(self.home)
        count = size = 0
        for folder in WRITABLE:
            inside = f'/proc/{self.pid}/root{folder}'
            try:
                if os.stat(inside).st_dev == os.stat(folder).st_dev:
                    continue  # still the host's: the sandbox is being set up, nothing runs in it
                found = os.statvfs(inside)
            except OSError:
                continue  # it has just ended
            count += found.f_files - found.f_ffree
            size += (found.f_blocks - found.f_bfree) * found.f_frsize
        return count, size


def end_group(process: subprocess.Popen[bytes]) -> None:
    """
    End a program that leads a process group, with the processes that it is setting up.

    bubblewrap's inner process waits forever if the outer one dies before it gives the signal to
    continue; until it has its own session, it is in this group.

    :param process: not waited for yet, or its number may be somebody else's
    """
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


KILLED = (-signal.SIGKILL, 128 + signal.SIGKILL)
"""Exit codes of a program that got SIGKILL, and of a launcher that passes that on."""
SUPERVISOR_S = 60.0  # bounds what it needs to end a sandbox's processes: milliseconds
WRITABLE = ('/tmp', '/dev/shm')
MOST_COUNTED = 30_000


def _tree(folder: Path) -> tuple[int, int]:
    """Count the files below a folder and their bytes, up to a limit; follow no link."""
    count = size = 0
    for path, folders, files in os.walk(folder):
        count += len(folders) + len(files)
        for name in files:
            with suppress(OSError):  # it changes while we look
                size += os.lstat(os.path.join(path, name)).st_blocks * 512
        if count > MOST_COUNTED:
            break
    return count, size
