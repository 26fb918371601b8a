"""
Start the program and the probe of a run, where possible as forks of processes with rclpy loaded.

bubblewrap creates the namespaces of the run, in which only a launcher runs.  The student's program
enters these namespaces and gives up its rights, so it is confined like a program that bubblewrap
starts.  The launcher exits with the fork's exit code, and the sandbox ends with the launcher.

The probe enters the network of the student's sandbox.  For root, the process that forks it has its
own sandbox.  A plain user's probe enters the user namespace of the student's sandbox, in which no
further namespace can be created.  There, Landlock confines the probe if the kernel supports it;
otherwise, only limits and the system-call filter do.  Without isolation, the probe runs unconfined
next to the student's program.
"""

import compileall
from contextlib import suppress
from dataclasses import replace
from functools import cache
import os
from pathlib import Path
import signal
from typing import Any

from autograder.clock.virtual_clock import VirtualClock
from autograder.errors import ProbeFailed
from autograder.inside.confine import family
from autograder.sandboxes import landlock
from autograder.sandboxes.confinement import ConfinedProgram, KILLED, Limits, Program
from autograder.sandboxes.fork_server import Fork, free_servers, Loaded
from autograder.sandboxes.processes import first_port
from autograder.sandboxes.sandbox import HERE, open_namespace, Sandbox

LAUNCHER = ('sh', '-c', f'read code; exit "${{code:-{KILLED[1]}}}"')
"""A command that waits for the program's exit code, and exits with the same code."""
FURTHER = ('mnt', 'pid', 'ipc', 'uts', 'cgroup')
"""Namespaces that a program enters but its probe does not."""
INSIDE = {str(HERE / 'inside'): '/grader/inside'}
FOLDER = '/tmp'
# Places on the virtual clock. If both processes are due at the same instant, the probe runs first.
PROBE, STUDENT = 0, 1
CODE = {str(HERE / name): f'/grader/{name}' for name in ('probe', 'inside')}
"""Folders of the grader that the fork server can read; students' sandboxes have ``inside`` too."""
START = '/grader/probe/probe.py'
FILTER = '/grader/filter.bpf'


@cache
def compile_code() -> None:
    """Compile the files that fork servers load, because the servers cannot write bytecode."""
    for folder in CODE:
        compileall.compile_dir(folder, quiet=2)  # ignores folders that are not writable


def start_program(
    sandbox: Sandbox,
    program: Program,
    limits: Limits,
    home: Path,
    clock: VirtualClock,
    builds: bool = False,
) -> ConfinedProgram:
    """
    Start the program of a run, which waits for :meth:`ConfinedProgram.release`.

    :param program: the command: Python, a script of the grader that forks on request or builds a
        package, and their arguments
    :param home: an existing empty folder
    :param builds: whether the script builds a package first
    :raises SandboxUnavailable: if bubblewrap or a fork server does not start
    :raises ProbeFailed: if the sandbox has ended, or a fork could not confine itself
    """
    compile_code()
    place = clock.places[STUDENT].fileno()
    if sandbox.facts.namespaces and not builds:
        return _start_fork(sandbox, program, limits, home, place)
    # Packages are built in real time. After the build, run_package.py and build_package.py load
    # the virtual clock's library into the program that replaces them.
    placed = clock.command(STUDENT, later=builds)
    program = replace(program, argv=(*placed, *program.argv))
    return sandbox.start(program, limits, home, (place,))


def _start_fork(
    sandbox: Sandbox, program: Program, limits: Limits, home: Path, place: int
) -> ConfinedProgram:
    loaded = Loaded(Program(tuple(program.argv[:2]), INSIDE), boxed=False)
    server, of_probe = free_servers(sandbox, loaded, loaded_probe(sandbox))
    of_probe.give_back()  # start_probe() takes it
    confined = sandbox.start(Program(LAUNCHER, program.binds), limits, home)
    try:
        with confined.gate as launcher:
            namespaces = _open_namespaces(confined)
            others = [place, launcher.fileno(), *namespaces]
            order = {
                'argv': program.argv[2:],
                'folder': FOLDER,
                'variables': {**program.variables, 'PWD': FOLDER},
                # Add 1 for the fork's parent, which has the same uid.
                'limits': limits.of_process(1 + sandbox.processes()),
                'rules': sandbox.rules(),
            }
            _attach_fork(confined, server.fork(order, others))
    except OSError as error:  # the sandbox has ended, and its namespaces with it
        confined.kill()
        what = f'The sandbox ended before the program began: {error}.'
        raise ProbeFailed(what) from error
    except BaseException:
        confined.kill()
        raise
    return confined


def _open_namespaces(confined: ConfinedProgram) -> list[int]:
    """Return descriptors of all namespaces of a sandbox, in the order in which to enter them."""
    for kind in FURTHER:
        confined.namespaces[kind] = open_namespace(confined.pid, kind)
    if 'user' in confined.namespaces:
        # This user namespace gives the right to enter the other namespaces. The launcher is in a
        # nested one, in which it has its own uid and cannot create further namespaces.
        launcher = [confined.pid, *family(confined.pid)][-1]
        confined.namespaces['nested'] = open_namespace(launcher, 'user')
    order = ('user', 'net', *FURTHER, 'nested')
    return [confined.namespaces[kind] for kind in order if kind in confined.namespaces]


def _attach_fork(confined: ConfinedProgram, fork: Fork) -> None:
    """Control the fork in place of the launcher."""
    confined.fork, confined.on_end, confined.gate = fork.pid, fork.server.ended, fork.gate
    for stream in (confined.process.stdout, confined.process.stderr):
        if stream is not None:
            stream.close()
    confined.process.stdout, confined.process.stderr = fork.stdout, fork.stderr


# -- the probe -----------------------------------------------------------------------------


class Probe:
    """The probe of one run; :meth:`end` closes the descriptors of its fork."""

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
