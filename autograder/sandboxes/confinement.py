"""Describe a program to confine and its limits, and control the program once it runs."""

from collections.abc import Callable, Mapping, Sequence
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
    The resources that one run may use before the grader ends it.

    :param cpu_s: processor time [s] of the program, the probe and the clock's driver together; the
        watchdog adds a share of the virtual time
    :param memory: resident memory [bytes] of all processes of the program together
    :param processes: number of processes and threads
    :param folder: size of each writable folder [bytes]
    :param inodes: number of files in the writable folders
    :param output: printed output [bytes]
    """

    cpu_s: int = 20
    memory: int = 1 << 30
    processes: int = 64
    folder: int = 64 << 20
    inodes: int = 20_000
    output: int = 8 << 20

    def of_process(self, others: int = 0) -> dict[str, int]:
        """
        Return the limits that the kernel enforces, named as in setrlimit(2) but in lower case.

        The watchdog enforces the limits that apply to all processes together.

        :param others: number of the uid's other processes and threads, which the kernel counts too
        """
        return {
            'nproc': self.processes + others,
            'as': 2 * self.memory,
            'fsize': self.folder,
            'core': 0,
            'nofile': 256,
            'cpu': 600,  # the watchdog ends each run earlier
        }

    def argv(self, others: int = 0) -> list[str]:
        """Return these limits as the prlimit prefix of a command."""
        limits = self.of_process(others).items()
        return ['prlimit', *(f'--{name}={value}' for name, value in limits), '--']


@dataclass(frozen=True)
class Program:
    """
    A command to run in a sandbox, and the files that it can see.

    :param argv: the command, with paths inside the sandbox
    :param binds: paths in the sandbox of read-only files and folders, by host path
    :param course_messages: whether the program can import the course's own message package
    :param variables: environment variables in addition to those of ROS
    """

    argv: Sequence[str]
    binds: Mapping[str, str] = field(default_factory=dict)
    course_messages: bool = True
    variables: Mapping[str, str] = field(default_factory=dict)


@dataclass
class ConfinedProgram:
    """
    A started program and the means to control it.

    :param process: the outermost process, which is the launcher if the mode has one
    :param gate: the grader's end of the program's standard input
    :param pid: host pid of the sandbox's first process; without namespaces, of ``process``
    :param pidfd: descriptor of the process with that pid; it stays correct if the pid is reused
    :param namespaces: open descriptors of the sandbox's namespaces that forks enter, by name in
        ``/proc``; for a plain user also ``user``, and ``nested`` for the user namespace inside it
    :param fork: host pid of the program if it is a fork, else 0; the ``process`` of a fork is a
        launcher that ends with the program's exit code
    :param on_end: waits until the parent of a fork has ended, and returns its exit code, or None
        if its server has failed
    :param supervised: whether :mod:`autograder.inside.confine` ends the program's descendants
    :param home: the folder that the program may write to, None if it has its own file system
    :param claimed: the program's ROS domain, None if it has its own network
    :param released: whether the release was sent successfully
    :param ended_unread: whether the program ended before it read the release; the socket reports
        this only once
    """

    process: subprocess.Popen[bytes]
    gate: socket.socket
    pid: int
    pidfd: int
    namespaces: dict[str, int] = field(default_factory=dict)
    fork: int = 0
    on_end: Callable[[], int | None] | None = None
    supervised: bool = False
    home: Path | None = None
    claimed: Claim | None = None
    released: bool = False
    ended_unread: bool = False

    def release(self) -> None:
        """
        Release the program, which waits in :mod:`autograder.inside.gate`.

        bubblewrap's own ``--block-fd`` is not suitable: if the grader is killed, a sandbox that
        waits for that descriptor survives and runs the program.
        """
        with suppress(OSError):  # the program has ended already; the run loop detects its exit
            self.gate.send(b'x')
            self.released = True

    def held(self) -> bool:
        """
        Return whether the program still waits, or ended before any student code ran.

        The kernel reports whether the byte in the socket was read, and no process inside can
        change this.  A program could reopen a pipe through ``/proc`` and fill it.
        """
        unread = fcntl.ioctl(self.gate, termios.TIOCOUTQ, bytes(4))
        ended = self.gate.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        self.ended_unread = self.ended_unread or ended == errno.ECONNRESET
        return not self.released or any(unread) or self.ended_unread

    def reported(self) -> bool:
        """
        Wait until a fork has ended, and return whether its exit code was reported.

        The fork's parent, which reports it, ends with 0 unless something outside killed it or its
        server.  Only the first call of this method waits.
        """
        on_end, self.on_end = self.on_end, None
        return on_end is None or on_end() == 0

    def kill(self) -> None:
        """End all processes inside, then the launcher; the reverse order could leave orphans."""
        try:
            if self.supervised:
                # The supervisor ends all descendants, including daemons, and then itself.
                signal.pidfd_send_signal(self.pidfd, signal.SIGTERM)
                select.select([self.pidfd], [], [], SUPERVISOR_S)
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)
        except ProcessLookupError:
            pass
        if not self.namespaces and not self.supervised:  # nothing else ends the descendants
            end_group(self.process)
        self.process.kill()
        self.process.wait()
        for descriptor in (self.pidfd, *self.namespaces.values()):
            os.close(descriptor)
        self.namespaces = {}
        self.reported()
        for stream in (self.process.stdout, self.process.stderr):
            if stream is not None:
                stream.close()
        self.gate.close()
        if self.claimed is not None:
            self.claimed.holder.close()

    @property
    def pids(self) -> tuple[int, ...]:
        """Return the host pids from which all processes of the sandbox descend."""
        return (self.pid, self.fork) if self.fork else (self.pid,)

    @property
    def domain(self) -> int:
        """Return the ROS domain id; 0 in a separate network."""
        return self.claimed.domain if self.claimed else 0

    def files(self) -> tuple[int, int]:
        """
        Return the number and total size [bytes] of the files that the program has created.

        The sandbox must be ready.  Until bubblewrap has changed the root folder, this method
        counts the files of the machine.
        """
        if self.home is not None:
            return _tree(self.home)
        count = size = 0
        for folder in WRITABLE:
            try:
                found = os.statvfs(f'/proc/{self.pid}/root{folder}')
            except OSError:
                continue  # the process has just ended
            count += found.f_files - found.f_ffree
            size += (found.f_blocks - found.f_bfree) * found.f_frsize
        return count, size


def end_group(process: subprocess.Popen[bytes]) -> None:
    """
    Kill a program and its whole process group.

    bubblewrap's inner process waits forever if the outer one dies before it sends the signal to
    continue.  Until the inner process has its own session, it is in this group.

    :param process: leader of the group, not yet reaped: a reaped pid may belong to another process
    """
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


KILLED = (-signal.SIGKILL, 128 + signal.SIGKILL)
"""Exit codes of a program killed by SIGKILL, and of a launcher that reports this."""
SUPERVISOR_S = 60.0  # timeout for ending a sandbox's processes, which takes milliseconds
WRITABLE = ('/tmp', '/dev/shm')
MOST_COUNTED = 30_000


def _tree(folder: Path) -> tuple[int, int]:
    """Count the files below a folder and their bytes, up to a limit; do not follow links."""
    count = size = 0
    for path, folders, files in os.walk(folder):
        count += len(folders) + len(files)
        for name in files:
            with suppress(OSError):  # the program may remove files during the count
                size += os.lstat(os.path.join(path, name)).st_blocks * 512
        if count > MOST_COUNTED:
            break
    return count, size
