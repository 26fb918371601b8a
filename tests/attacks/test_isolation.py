"""Test the guarantees of the sandbox, from inside and outside."""

from pathlib import Path
import subprocess
import sys

import pytest

import autograder
from autograder.sandboxes.choose import strongest
from autograder.sandboxes.confinement import Limits, Program
from autograder.sandboxes.processes import usage

pytestmark = [pytest.mark.attacks, pytest.mark.ros]


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
