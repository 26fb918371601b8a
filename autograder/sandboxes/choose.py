"""
Choose the strongest isolation mode that works on this machine, or an accepted weaker one.

A mode works only if it passes a trial, which starts a program and a probe as a run does.  The
program must be able to use rclpy, must not be able to read the grader's files, and must have
virtual time.  The probe must be able to enter the program's network.
"""

import functools
import os
from pathlib import Path
import shutil
import subprocess
import tempfile

from autograder.clock import virtual_clock
from autograder.clock.virtual_clock import SYSTEM_TIME_NS, VirtualClock
from autograder.errors import ProbeFailed, SandboxUnavailable
from autograder.sandboxes import isolation, landlock
from autograder.sandboxes.confinement import ConfinedProgram, KILLED, Limits, Program
from autograder.sandboxes.forked import INSIDE, PROBE, start_probe, start_program
from autograder.sandboxes.sandbox import HERE, Sandbox

TRIAL = ('/grader/inside/run_node.py', '/grader/inside/trial.py')
TRIAL_S = 20


@functools.lru_cache(maxsize=4)
def strongest(allow_weak: str = '') -> Sandbox:
    """
    Return the strongest sandbox that works on this machine, after a trial run.

    :param allow_weak: the weakest accepted mode of :data:`autograder.sandboxes.isolation.WEAK`;
        empty to require full isolation
    :raises SandboxUnavailable: if no mode works, with the fix and the modes that could be accepted
    """
    root = os.geteuid() == 0
    refusals: dict[str, SandboxUnavailable] = {}
    for mode in (isolation.full(root), *isolation.permitted(allow_weak, root)):
        try:
            return usable(mode)
        except SandboxUnavailable as error:
            refusals[mode] = error
    (_, refusal), *others = refusals.items()
    reasons = [f'{mode}: {error}' for mode, error in others]
    if offers := () if allow_weak else isolation.permitted(isolation.WEAK[-1], root):
        options = ' or '.join(f'--allow-weak={mode}' for mode in offers)
        reasons.append(f'To accept weaker isolation: {options}.')
    raise SandboxUnavailable(refusal.what, ' '.join([refusal.fix, *reasons])) from refusal


def usable(mode: str) -> Sandbox:
    """
    Return the sandbox of a mode, after a trial run.

    :raises SandboxUnavailable: if the mode does not work on this machine, with the fix
    """
    sandbox = Sandbox(mode)
    virtual_clock.check_clock()
    if sandbox.keeps_secrets:
        what, fix = _missing(sandbox)
        if what:
            raise SandboxUnavailable(what, fix)
        try_out(sandbox)
    return sandbox


def _missing(sandbox: Sandbox) -> tuple[str, str]:
    """Return what the system lacks for a sandbox, and the fix; both empty if it lacks nothing."""
    if not landlock.filter_file().is_file():
        return landlock.NO_FILTER
    if sandbox.facts.namespaces:
        found = shutil.which('bwrap') is not None
        return ('', '') if found else ('bubblewrap is not installed.', isolation.FIX_MISSING)
    needed = (*sandbox.ros.read_only, str(HERE / 'inside'))
    if sandbox.facts.root and (folder := landlock.closed_folder(needed)):
        return (
            f'{folder} is closed to other users, and Python or the course is in it.',
            f'Move Python or the course, or let other users in: chmod o+x {folder}',
        )
    return landlock.refusal(sandbox.facts.root)


def try_out(sandbox: Sandbox) -> None:
    """
    Try to start a program and a probe as a run does, and to read the grader's files.

    :raises SandboxUnavailable: if one of them does not start, can read the files, or has real time
    """
    now = str(SYSTEM_TIME_NS / 1e9)
    program = Program((sandbox.ros.python, *TRIAL, __file__, now), INSIDE)
    try:
        with (
            sandbox.turn(),
            tempfile.TemporaryDirectory(prefix='trial-') as home,
            virtual_clock.virtual_clock(2) as clock,
        ):
            confined = start_program(sandbox, program, Limits(), Path(home), clock)
            try:
                said, error = _answer(sandbox, confined, clock)
            finally:
                confined.kill()
    except ProbeFailed as refused:
        raise SandboxUnavailable(refused.what, isolation.fix_for(refused.what)) from refused
    if confined.process.returncode in KILLED:
        what = f'Another program ended the trial of isolation {sandbox.mode}.'
        raise SandboxUnavailable(what, 'Try: run the same command again')
    if said == 'open':
        raise SandboxUnavailable(
            f"Isolation {sandbox.mode} lets a program read the grader's files.", isolation.SECTION
        )
    if said == 'real':
        what = f'With isolation {sandbox.mode}, a program does not load the virtual clock: {error}'
        raise SandboxUnavailable(f'{what}.', isolation.SECTION)
    if said != 'in':
        what = f'rclpy does not run with isolation {sandbox.mode}: {error}.'
        raise SandboxUnavailable(what, isolation.fix_for(error))


def _answer(sandbox: Sandbox, confined: ConfinedProgram, clock: VirtualClock) -> tuple[str, str]:
    """Start the probe, release the program, and return its output and its last error line."""
    probe = start_probe(sandbox, confined, clock.places[PROBE].fileno())
    clock.begin()
    confined.release()
    try:
        said, error = confined.process.communicate(timeout=TRIAL_S)
    except subprocess.TimeoutExpired as late:
        what = f'A trial program did not end within {TRIAL_S} s.'
        raise SandboxUnavailable(what, 'Try: make doctor') from late
    finally:
        probe.end()
    lines = error.decode(errors='replace').strip().splitlines()
    return said.decode(errors='replace').strip(), (lines or [''])[-1]
