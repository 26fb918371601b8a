"""
Choose the strongest isolation mode that works on this machine, or an accepted weaker one.

A mode works only if it provides everything that a run needs.  Inside the sandbox, rclpy can be
imported, the grader's files cannot be read, and time is virtual.  From outside, the probe can
enter the sandbox's network.
"""

from __future__ import annotations

import functools
import os
from pathlib import Path
import shutil
import subprocess
import tempfile

from autograder.clock.virtual_clock import SYSTEM_TIME_NS, virtual_clock
from autograder.errors import SandboxUnavailable
from autograder.sandboxes import isolation, landlock
from autograder.sandboxes.confined import KILLED, Limits, Program
from autograder.sandboxes.sandbox import HERE, Sandbox

TRIAL = """
import rclpy, sys, time
try:
    open(sys.argv[1]).close()
except OSError:
    print('in' if abs(time.time() - float(sys.argv[2])) < 3600 else 'real')
else:
    print('open')
"""


@functools.lru_cache(maxsize=4)
def strongest(allow_weak: str = '') -> Sandbox:
    """
    Return the strongest sandbox that works on this machine, after a trial run.

    :param allow_weak: the weakest accepted mode of :data:`autograder.sandboxes.isolation.WEAK`;
        empty to require full isolation
    :raises SandboxUnavailable: with the exact fix, and the weaker modes that the user may accept
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

    :raises SandboxUnavailable: with the exact fix, if the mode does not work on this machine
    """
    sandbox = Sandbox(mode)
    if sandbox.keeps_secrets:
        what, fix = _missing(sandbox)
        if what:
            raise SandboxUnavailable(what, fix)
        try_out(sandbox)
    return sandbox


def _missing(sandbox: Sandbox) -> tuple[str, str]:
    """Return what the system lacks for a sandbox, and the fix; empty strings if nothing."""
    if not landlock.filter_file().is_file():
        return landlock.NO_FILTER
    if sandbox.isolated:
        found = shutil.which('bwrap') is not None
        return ('', '') if found else ('bubblewrap is not installed.', isolation.FIX_MISSING)
    needed = (*sandbox.ros.read_only, str(HERE / 'inside'))
    if sandbox.facts.root and (folder := landlock.closed_folder(needed)):
        return (
            f'{folder} is closed to other users, and Python or the course is below it.',
            f'Move them, or let other users in: chmod o+x {folder}',
        )
    return landlock.refusal(sandbox.facts.root)


def try_out(sandbox: Sandbox) -> None:
    """
    Try to enter a sandbox's network, import rclpy inside, and read the grader's files.

    :raises SandboxUnavailable: if entering or importing fails, reading succeeds, or time is real
    """
    with (
        sandbox.turn(),
        tempfile.TemporaryDirectory(prefix='trial-') as folder,
        virtual_clock(1) as clock,
    ):
        Path(folder).chmod(0o755)
        home = Path(folder, 'home')
        home.mkdir()
        now = str(SYSTEM_TIME_NS / 1e9)
        argv = (*clock.command(0), sandbox.ros.python, '-c', TRIAL, __file__, now)
        confined = sandbox.start(Program(argv), Limits(), home, (clock.places[0].fileno(),))
        clock.begin()
        try:
            if sandbox.isolated:
                # Enter its network in the same way as the probe.
                held = tuple(confined.namespaces.values())
                command = [*confined.enter, 'true']
                joined = subprocess.run(command, pass_fds=held, capture_output=True, text=True)
                if joined.returncode != 0:
                    what = f'The probe cannot join the sandbox network: {joined.stderr.strip()}.'
                    raise SandboxUnavailable(what, isolation.fix_for('namespace'))
            confined.release()
            said, error = confined.process.communicate(timeout=20)
        except subprocess.TimeoutExpired as late:
            what = 'rclpy could not be imported within 20 s.'
            raise SandboxUnavailable(what, 'Try: make doctor') from late
        finally:
            confined.kill()
    if confined.process.returncode in KILLED:
        what = f'Another program ended the trial of isolation {sandbox.mode}.'
        raise SandboxUnavailable(what, 'Try: run the same command again')
    if said.strip() == b'open':
        raise SandboxUnavailable(
            f'Isolation {sandbox.mode} lets a program read grader files.', isolation.SECTION
        )
    if said.strip() == b'real':
        what = f'With isolation {sandbox.mode}, a program does not load the virtual clock.'
        raise SandboxUnavailable(what, 'Try: make doctor')
    if said.strip() != b'in':
        tail = ' '.join(error.decode(errors='replace').strip().splitlines()[-1:])
        fix = isolation.fix_for(tail) if tail.startswith('bwrap: ') else 'Try: make doctor'
        raise SandboxUnavailable(f'rclpy does not run with isolation {sandbox.mode}: {tail}.', fix)
