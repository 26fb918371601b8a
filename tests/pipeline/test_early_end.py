"""A run that is stopped during the set-up of its sandboxes leaves nothing behind."""

from pathlib import Path
import signal
import socket

import pytest

from autograder.sandboxes.choose import strongest
from autograder.sandboxes.confinement import Limits, Program
from autograder.sandboxes.forked import start_probe

pytestmark = [pytest.mark.pipeline]


@pytest.mark.parametrize('turn', range(3))
def test_a_probe_ends_at_whatever_moment_it_is_killed(tmp_path: Path, turn: int):
    """The pipes of the killed probe close, so no process waits for them forever."""
    sandbox = strongest()
    home = tmp_path / 'home'
    home.mkdir()
    student = sandbox.start(
        Program((sandbox.ros.python, '-c', 'import sys; sys.stdin.read()')), Limits(), home
    )
    try:
        ours, theirs = socket.socketpair()
        with ours, theirs:
            probe = start_probe(sandbox, student, theirs.fileno())
            probe.kill()
        said = probe.stdout.read()
        words = probe.end()
    finally:
        student.kill()

    assert said == b''
    assert words == ''
    assert probe.returncode == -signal.SIGKILL
