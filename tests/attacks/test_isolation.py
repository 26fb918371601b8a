"""Test the guarantees of the sandbox, from inside and outside."""

import os
from pathlib import Path
import select
import signal
import subprocess
import sys

import pytest

import autograder
from autograder.runs.program import submission_folder
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.confinement import Limits, Program
from autograder.sandboxes.forked import INSIDE
from autograder.sandboxes.processes import usage

pytestmark = [pytest.mark.attacks, pytest.mark.ros]

LAUNCHER = """
import sys
from pathlib import Path
from autograder.sandboxes.confinement import Limits, Program
from autograder.inside.confine import family
from autograder.sandboxes.choose import strongest
box = strongest()
argv = (box.ros.python, '/grader/inside/run_node.py', '/submission/x.py')
program = Program(argv, {sys.argv[1]: '/grader/inside', sys.argv[2]: '/submission'})
confined = box.start(program, Limits(), Path('/'))
if sys.argv[3] == 'running':
    confined.release()
    confined.process.stdout.readline()
while len(list(family(confined.pid))) < 2:  # bubblewrap's first process, and the program
    pass
print(confined.pid, flush=True)
sys.stdin.read()
"""


def gone(pidfd: int, seconds: float) -> bool:
    """Return whether a process ends within a number of seconds."""
    return bool(select.select([pidfd], [], [], seconds)[0])


@pytest.mark.parametrize('moment', ['held', 'running'])
def test_nothing_outlives_a_killed_grader(moment):
    endless = 'print("up", flush=True)\nwhile True:\n    pass\n'
    with submission_folder({'x.py': endless}) as (submission, _):
        grader = subprocess.Popen(
            [sys.executable, '-c', LAUNCHER, *INSIDE, str(submission), moment],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        pidfd = os.pidfd_open(int(grader.stdout.readline()))
        grader.send_signal(signal.SIGKILL)
        grader.communicate()
        try:
            assert gone(pidfd, 10)
        finally:
            os.close(pidfd)


def test_environment_and_command_line_of_the_launcher_say_nothing(monkeypatch):
    """The first process inside shows neither the grader's variables nor its paths."""
    monkeypatch.setenv('GRADER_SECRET', 'CANARY')
    box = strongest()
    code = 'print(open("/proc/1/environ").read(), open("/proc/1/cmdline").read())'
    confined = box.start(Program((box.ros.python, '-c', code)), Limits(), Path('/'))
    try:
        confined.release()
        said, _ = confined.process.communicate(timeout=60)
    finally:
        confined.kill()

    assert b'CANARY' not in said
    assert str(Path(autograder.__file__).parent).encode() not in said
    assert str(Path(__file__).parent).encode() not in said


def test_usage_counts_the_memory_of_children():
    """The watchdog must also count the memory of daemons."""
    code = (
        'import os\nif os.fork() == 0:\n    held = bytearray(b"x") * (64 << 20)\n'
        '    print("held", flush=True)\n    input()\nelse:\n    os.wait()\n'
    )
    with subprocess.Popen(
        [sys.executable, '-c', code], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as parent:
        parent.stdout.readline()
        used = usage(parent.pid)
        parent.communicate(b'\n')

    assert used.resident > 64 << 20
    assert used.cpu_s >= 0
