"""
Start a student's program, where possible as a fork of a process that has rclpy loaded.

bubblewrap creates the namespaces of the run, in which only a launcher runs.  The fork enters these
namespaces and gives up its rights, so it is confined like a program that bubblewrap starts.  The
launcher exits with the fork's exit code, and the sandbox ends with the launcher.
"""

from dataclasses import replace
from pathlib import Path

from autograder.clock.virtual_clock import VirtualClock
from autograder.errors import ProbeFailed
from autograder.inside.confine import family
from autograder.sandboxes.confinement import ConfinedProgram, KILLED, Limits, Program
from autograder.sandboxes.fork_server import Fork, free_servers, Loaded
from autograder.sandboxes.probes import compile_code, loaded_probe
from autograder.sandboxes.sandbox import HERE, open_namespace, Sandbox

LAUNCHER = ('sh', '-c', f'read code; exit "${{code:-{KILLED[1]}}}"')
"""A command that waits for the program's exit code, and exits with the same code."""
FURTHER = ('mnt', 'pid', 'ipc', 'uts', 'cgroup')
"""Namespaces that a program enters but its probe does not."""
INSIDE = {str(HERE / 'inside'): '/grader/inside'}
FOLDER = '/tmp'
# Places on the virtual clock. If both processes are due at the same instant, the probe runs first.
PROBE, STUDENT = 0, 1


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
