"""
Start a run's probe in the network of the student's sandbox, apart from the student.

As root a probe is a copy of a process that is kept ready in a sandbox of its own, see
:mod:`autograder.probe.warm_probe`: one for each thread that runs submissions.  The copy is there
in milliseconds, where a Python of its own takes longer to load rclpy than it then works.

A plain user's probe joins the user namespace of the student's sandbox, in which no further one can
be made; there, Landlock confines it where the kernel has it, and limits and a bare environment are
all it has where not.  Without isolation it stands beside the student's program.
"""

from __future__ import annotations

from functools import partial
import os
from pathlib import Path
import shutil
import subprocess

from autograder.sandboxes import landlock
from autograder.sandboxes import sandbox as sandboxes
from autograder.sandboxes.confined import Confined, end_group, Limits, Probe, Program
from autograder.sandboxes.processes import first_port
from autograder.sandboxes.sandbox import HERE, Sandbox
from autograder.sandboxes.warm_probes import warm_probes

FILES = (
    'probe/probe.py',
    'probe/probe_graph.py',
    'probe/probe_loopback.py',
    'probe/probe_round_trips.py',
    'probe/probe_steps.py',
    'probe/probe_wire.py',
    'probe/probe.xml',
    'probe/warm_probe.py',
    'inside/lean_start.py',
    'inside/system_calls.py',
)
"""What the probe consists of."""
# It works for as long as the program is watched, so the wall clock's limit comes first.
LIMITS = Limits(cpu_s=120)


def start_probe(sandbox: Sandbox, student: Confined, home: Path) -> Probe:
    """
    Start a probe, which waits for its scenario.

    :param student: the held program
    :param home: the student's; a probe's own is made beside it where it needs one
    :raises ProbeFailed: if it cannot be started
    """
    if sandbox.mode == 'bwrap-root':
        binds = {str(HERE / name): f'/grader/{Path(name).name}' for name in FILES}
        program = Program(
            (sandbox.ros.python, '/grader/warm_probe.py'),
            {**binds, str(landlock.filter_file()): '/grader/filter.bpf'},
            variables=_variables(Path('/grader'), student.domain),
        )
        return warm_probes(sandbox, program, LIMITS).make(student.namespaces['net'])
    own, code = home.parent / 'probe', home.parent / 'code'
    for folder in (own, code):
        folder.mkdir(mode=0o755)
    for name in FILES:  # Python lists the folder, whose neighbours are no business of it
        shutil.copy(HERE / name, code)
    program = Program(
        (sandbox.ros.python, '/grader/probe.py'),
        {str(code): '/grader'},
        variables=_variables(code, student.domain),
    )
    run, variables = sandbox.outside(program, LIMITS, own, student.domain)
    if sandbox.mode != 'none' and not landlock.refusal(root=os.geteuid() == 0)[0]:
        run = [*sandbox.behind_landlock(program, own), *run]
    fds = student.namespaces
    if sandbox.mode == 'bwrap-user':
        enter = ['nsenter', f'--net=/proc/self/fd/{fds["net"]}']
        enter += [f'--user=/proc/self/fd/{fds["user"]}']
        assign = [f'{name}={value}' for name, value in variables.items()]
        run = [*enter, '--preserve-credentials', '--', 'env', '-i', *assign, *run]
        variables = sandboxes.BARE
    process = subprocess.Popen(
        run, pass_fds=tuple(fds.values()), env=variables, cwd=own, **sandboxes.PIPES
    )
    assert process.stdin
    assert process.stdout
    assert process.stderr
    kill = partial(end_group, process)
    return Probe(process.pid, process.stdin, process.stdout, process.stderr, kill, process.wait)


def _variables(folder: Path, domain: int) -> dict[str, str]:
    """
    Return the probe's own variables: where its profile is, and the port that it names.

    :param folder: of the probe's files, as the probe sees it
    """
    return {
        'FASTRTPS_DEFAULT_PROFILES_FILE': str(folder / 'probe.xml'),
        'UNICAST_PORT': str(first_port(domain)),
    }
