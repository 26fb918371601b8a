"""
Try a sandbox: a mode counts as working only if it does everything that a run needs.

Inside, rclpy can be imported, the grader's files cannot be read, and time is virtual.  From
outside, the probe can enter the sandbox's network.
"""

from __future__ import annotations

from pathlib import Path
import subprocess
import tempfile
from typing import TYPE_CHECKING

from autograder.clock.virtual_clock import SYSTEM_TIME_NS, virtual_clock
from autograder.errors import SandboxUnavailable
from autograder.sandboxes import isolation
from autograder.sandboxes.confined import Confined, KILLED, Limits, Program
from autograder.sandboxes.isolation import fix_for, System

if TYPE_CHECKING:
    from autograder.sandboxes.sandbox import Sandbox

TRIAL = """
import rclpy, sys, time
try:
    open(sys.argv[1]).close()
except OSError:
    print('in' if abs(time.time() - float(sys.argv[2])) < 3600 else 'real')
else:
    print('open')
"""


def try_out(sandbox: Sandbox) -> None:
    """
    Run a Python that imports rclpy and cannot read the grader; then join its network.

    :raises SandboxUnavailable: if one of these does not work
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
                _try_to_join(confined)
            confined.release()
            try:
                said, error = confined.process.communicate(timeout=20)
            except subprocess.TimeoutExpired as late:
                what = 'rclpy did not import within 20 s.'
                raise SandboxUnavailable(what, 'Try: make doctor') from late
        finally:
            confined.kill()
    if confined.process.returncode in KILLED:
        what = f'Another program ended the trial of isolation {sandbox.mode}.'
        raise SandboxUnavailable(what, 'Try: run the same command again')
    if said.strip() == b'open':
        raise SandboxUnavailable(
            f'Isolation {sandbox.mode} lets a program read the grader.', isolation.SECTION
        )
    if said.strip() == b'real':
        what = f'With isolation {sandbox.mode}, a program does not load the virtual clock.'
        raise SandboxUnavailable(what, 'Try: make doctor')
    if said.strip() != b'in':
        tail = ' '.join(error.decode(errors='replace').strip().splitlines()[-1:])
        raise SandboxUnavailable(
            f'rclpy does not run with isolation {sandbox.mode}: {tail}.', 'Try: make doctor'
        )


def _try_to_join(confined: Confined) -> None:
    """Join a sandbox's network as the probe will."""
    joined = subprocess.run(
        [*confined.enter, 'true'],
        pass_fds=tuple(confined.namespaces.values()),
        capture_output=True,
        text=True,
        check=False,
    )
    if joined.returncode != 0:
        raise SandboxUnavailable(
            f'The probe cannot join the sandbox network: {joined.stderr.strip()}.',
            fix_for('namespace', System.here()),
        )
