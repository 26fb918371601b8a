"""The state of a program, observed from outside."""

from contextlib import contextmanager, suppress
import os
import signal
import subprocess
import sys

import pytest

from autograder.inside.confine import family
from autograder.sandboxes.processes import running, usage

pytestmark = pytest.mark.timeout(60)

# Each program prints x when its threads and child processes are set up.
SLEEPS = "import threading; print('x', flush=True); threading.Event().wait()"
COMPUTES = "print('x', flush=True)\nwhile True: pass"
THREADS = f"""
import threading
for _ in range(3):
    threading.Thread(target=threading.Event().wait, daemon=True).start()
{SLEEPS}
"""
CHILD = f"""
import subprocess, sys
child = subprocess.Popen([sys.executable, '-c', {COMPUTES!r}], stdout=subprocess.PIPE)
child.stdout.readline()
{SLEEPS}
"""
ZOMBIE = f"""
import os
if (child := os.fork()) == 0:
    os._exit(0)
os.waitid(os.P_PID, child, os.WEXITED | os.WNOWAIT)
{SLEEPS}
"""


@contextmanager
def started(program):
    """Yield a program that has printed x."""
    argv = [sys.executable, '-c', program]
    with subprocess.Popen(argv, stdout=subprocess.PIPE, start_new_session=True) as process:
        try:
            assert process.stdout.readline() == b'x\n'
            yield process
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)


def states(pid: int) -> bytes:
    return b''.join(one.states for one in usage(pid).each.values())


def used_s(pid: int) -> float:
    return sum(one.used_s for one in usage(pid).each.values())


def reaches(process, wanted: bytes) -> bool:
    """Wait until each thread is in one of these states."""
    while not set(found := states(process.pid)) <= set(wanted):
        assert found
    return True


@pytest.mark.parametrize(('program', 'threads'), [(SLEEPS, 1), (THREADS, 4)])
def test_threads_that_wait_are_asleep(program, threads):
    with started(program) as process:
        assert reaches(process, b'S')
        assert len(states(process.pid)) == threads


def test_a_program_that_computes_is_seen_in_its_parent():
    with started(CHILD) as process:
        before = used_s(process.pid)

        while used_s(process.pid) < before + 0.05:
            assert b'R' in states(process.pid)
        assert len(list(family(process.pid))) == 2


def test_a_stopped_program_is_seen_as_one():
    with started(COMPUTES) as process:
        process.send_signal(signal.SIGSTOP)

        assert reaches(process, b'T')


def test_child_that_has_ended_is_not_running():
    """The kernel lists an ended child until its parent asks for the exit code."""
    with started(ZOMBIE) as process:
        assert len(list(family(process.pid))) == 2
        assert running(process.pid) == [process.pid]


def test_a_program_that_has_ended_has_nothing():
    with started(SLEEPS) as process:
        process.kill()
        process.wait()

        assert (list(family(process.pid)), used_s(process.pid)) == ([], 0)
        assert states(process.pid) == b''
