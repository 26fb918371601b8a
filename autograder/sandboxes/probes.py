"""
Start a run's probe in the network of the student's sandbox, apart from the student.

As root, the probe has a separate sandbox, which shares the student's network and nothing else.  A
plain user's probe joins the user namespace of the student's sandbox, in which no further namespace
can be made.  There, Landlock confines the probe if the kernel has it; if not, limits and a bare
environment are its only confinement.  Without isolation the probe runs next to the student's
program.
"""

from __future__ import annotations

from collections.abc import Sequence
import compileall
from functools import cache
import os
from pathlib import Path
import shutil
import subprocess

from autograder.sandboxes import landlock
from autograder.sandboxes import sandbox as sandboxes
from autograder.sandboxes.confined import Confined, Limits, Probe, Program
from autograder.sandboxes.processes import first_port
from autograder.sandboxes.sandbox import HERE, Sandbox

CODE = {str(HERE / name): f'/grader/{name}' for name in ('probe', 'inside')}
"""Folders that a probe sees; of the second, it shares one file with the student's side."""
START = '/grader/probe/probe.py'
LIMITS = Limits()
HALF_WRITTEN = shutil.ignore_patterns('*.pyc.*')


@cache
def compile_code() -> None:
    """Keep bytecode beside what each run starts: inside a sandbox Python can keep none."""
    for folder in CODE:
        compileall.compile_dir(folder, quiet=2)  # not if it may not write there


def start_probe(
    sandbox: Sandbox,
    student: Confined,
    home: Path,
    clock: Sequence[str],
    inherited: Sequence[int],
) -> Probe:
    """
    Start a probe, which waits for its scenario.

    :param student: the held program
    :param home: the student's; a probe's own is made beside it where it needs one
    :param clock: command before its own, by which it finds the virtual clock
    :param inherited: the descriptor that it names
    """
    argv = (*clock, sandbox.ros.python, START)
    fds = (*student.namespaces.values(), *inherited)
    if sandbox.facts.namespaces and sandbox.facts.root:
        program = Program(argv, CODE, variables=_variables(Path('/grader'), student.domain))
        process = _in_a_sandbox(sandbox, program, student.enter, fds)
    else:
        own, code = home.parent / 'probe', home.parent / 'code'
        own.mkdir(mode=0o755)
        for folder in CODE:  # Python lists the folders, and must not see their neighbours
            shutil.copytree(folder, code / Path(folder).name, ignore=HALF_WRITTEN)
        code.chmod(0o755)
        variables = _variables(code, student.domain)
        program = Program(argv, {str(code): '/grader'}, variables=variables)
        run, variables = sandbox.outside(program, LIMITS, own, student.domain)
        if sandbox.keeps_secrets and not landlock.refusal(root=os.geteuid() == 0)[0]:
            run = [*sandbox.behind_landlock(program, own, inherited), *run]
        assign = [f'{name}={value}' for name, value in variables.items()]
        run = [*student.enter, 'env', '-i', *assign, *run]
        process = subprocess.Popen(
            run, pass_fds=fds, env=sandboxes.BARE, cwd=own, **sandboxes.PIPES
        )
    return Probe(process)


def _in_a_sandbox(
    sandbox: Sandbox, program: Program, enter: Sequence[str], fds: Sequence[int]
) -> subprocess.Popen[bytes]:
    """Start a probe with separate mounts and processes, in the student's network."""
    rules = os.open(landlock.filter_file(), os.O_RDONLY)
    try:
        descriptors = ['--seccomp', str(rules)]
        options = sandbox.bwrap(program, LIMITS, descriptors, network=False)
        command = sandbox.command(program, LIMITS)
        return sandboxes.start_bwrap(options, command, (*fds, rules), enter)
    finally:
        os.close(rules)


def _variables(folder: Path, domain: int) -> dict[str, str]:
    """
    Return the probe's own variables: the path of its profile and the port in it.

    :param folder: of the grader's code, as the probe sees it
    """
    return {
        'FASTRTPS_DEFAULT_PROFILES_FILE': str(folder / 'probe' / 'probe.xml'),
        'UNICAST_PORT': str(first_port(domain)),
    }
