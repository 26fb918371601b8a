"""
Create a run's probe in the network of the student's sandbox, separate from the student's program.

A probe is a fork of a process that has rclpy loaded.  For root, this process has its own sandbox.
A plain user's probe enters the user namespace of the student's sandbox, in which no further
namespace can be created.  There, Landlock confines the probe if the kernel supports it; otherwise,
only limits and the system-call filter do.  Without isolation, the probe runs unconfined next to
the student's program.
"""

import compileall
from contextlib import suppress
from functools import cache
import os
from pathlib import Path
import signal
from typing import Any

from autograder.sandboxes import landlock
from autograder.sandboxes.confinement import ConfinedProgram, Limits, Program
from autograder.sandboxes.fork_server import Fork, free_servers, Loaded
from autograder.sandboxes.processes import first_port
from autograder.sandboxes.sandbox import HERE, Sandbox

CODE = {str(HERE / name): f'/grader/{name}' for name in ('probe', 'inside')}
"""Folders of the grader that the fork server can read; students' sandboxes have ``inside`` too."""
START = '/grader/probe/probe.py'
FILTER = '/grader/filter.bpf'


@cache
def compile_code() -> None:
    """Compile the files that fork servers load, because the servers cannot write bytecode."""
    for folder in CODE:
        compileall.compile_dir(folder, quiet=2)  # ignores folders that are not writable


class Probe:
    """
    The probe of one run.

    :param fork: the probe's process, whose descriptors :meth:`end` closes
    """

    def __init__(self, fork: Fork) -> None:
        self.fork, self.pid, self.stdout = fork, fork.pid, fork.stdout
        self.pidfd = os.pidfd_open(fork.pid)
        self.returncode: int | None = None

    def tell(self, line: bytes) -> None:
        """Write to the probe's standard input, unless the probe has ended."""
        with suppress(ConnectionError):
            self.fork.gate.sendall(line)

    def kill(self) -> None:
        """Kill the probe if it is still running."""
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(self.pidfd, signal.SIGKILL)

    def end(self) -> str:
        """Kill the probe, read its exit code, and return the last line of its standard error."""
        self.kill()
        said = self.fork.stderr.read().decode(errors='replace').strip()
        self.returncode = self.fork.server.ended()
        os.close(self.pidfd)
        for stream in (self.fork.gate, self.fork.stdout, self.fork.stderr):
            stream.close()
        return (said.splitlines() or [''])[-1]


def loaded_probe(sandbox: Sandbox) -> Loaded:
    """Return the program whose forks are probes."""
    binds = {**CODE, str(landlock.filter_file()): FILTER}
    boxed = sandbox.facts.namespaces and sandbox.facts.root
    return Loaded(Program((sandbox.ros.python, START), binds), boxed)


def start_probe(sandbox: Sandbox, student: ConfinedProgram, place: int) -> Probe:
    """
    Start a probe, which waits for its scenario.

    :param student: the program, which has not been released yet
    :param place: descriptor of the probe's socket for the virtual clock
    :raises ProbeFailed: if the probe could not confine itself, or has ended
    :raises SandboxUnavailable: if the fork server does not start
    """
    loaded = loaded_probe(sandbox)
    (server,) = free_servers(sandbox, loaded)
    # Enter the user namespace first, which gives the right to enter the network namespace.
    namespaces = [student.namespaces[one] for one in ('user', 'net') if one in student.namespaces]
    return Probe(server.fork(_order(sandbox, loaded, student), [place, *namespaces]))


def _order(sandbox: Sandbox, loaded: Loaded, student: ConfinedProgram) -> dict[str, Any]:
    folder, domain = Path('/grader') if loaded.boxed else HERE, student.domain
    return {
        'argv': (),
        'folder': '',
        'variables': {
            'ROS_DOMAIN_ID': str(domain),
            'FASTRTPS_DEFAULT_PROFILES_FILE': str(folder / 'probe' / 'probe.xml'),
            'UNICAST_PORT': str(first_port(domain)),
        },
        'limits': Limits().of_process(sandbox.processes()),
        'rules': _rules(sandbox, loaded),
    }


def _rules(sandbox: Sandbox, loaded: Loaded) -> dict[str, Any] | None:
    """Return the rules for :func:`confine.give_up`; None if a probe keeps its rights."""
    if loaded.boxed:
        return {**sandbox.rules(), 'filter': FILTER}
    if not sandbox.keeps_secrets:
        return None
    if landlock.refusal(sandbox.facts.root)[0]:
        return sandbox.rules()
    return sandbox.landlock_rules(loaded.program)
