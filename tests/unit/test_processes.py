"""What a program does, seen from outside."""

from __future__ import annotations

from contextlib import contextmanager
import subprocess
import sys

import pytest

from autograder.errors import TooBusy
from autograder.sandboxes import processes
from autograder.sandboxes.processes import BUSY_S, Threads

# Each says a word when its threads are at it.
SLEEPS = "import threading; print('x', flush=True); threading.Event().wait()"
COMPUTES = "print('x', flush=True)\nwhile True: pass"
COMPUTES_FOR_A_WHILE = """
import threading, time
def callback():
    until = time.thread_time() + 0.03
    print('x', flush=True)
    while time.thread_time() < until:
        pass
    print('done', flush=True)
    threading.Event().wait()
threading.Thread(target=callback, daemon=True).start()
threading.Event().wait()
"""


@contextmanager
def started(program):
    """Yield a program that has said its first word, and its threads."""
    with subprocess.Popen([sys.executable, '-c', program], stdout=subprocess.PIPE) as process:
        threads = Threads(process.pid)
        try:
            assert process.stdout.readline() == b'x\n'
            yield process, threads
        finally:
            threads.close()
            process.kill()


def test_a_program_that_sleeps_is_quiet():
    """All of its threads wait for something."""
    with started(SLEEPS) as (_, threads):
        assert threads.wait_until_quiet()


def test_a_callback_on_another_thread_is_waited_for():
    """Quiet is when it is over, and what it did is done then."""
    with started(COMPUTES_FOR_A_WHILE) as (process, threads):
        assert threads.wait_until_quiet()
        assert process.stdout.readline() == b'done\n'
        assert threads.used_s() >= 0.02  # the kernel counts in hundredths


def test_a_program_that_always_computes_is_left_alone():
    """After the processor time that is enough to tell, and not after wall time."""
    with started(COMPUTES) as (_, threads):
        before = threads.used_s()

        assert not threads.wait_until_quiet()
        assert threads.used_s() >= before + BUSY_S


def test_a_program_that_gets_no_processor_is_nobodys_mistake(monkeypatch):
    """Nothing is known about it then, so the run is repeated and not judged."""
    monkeypatch.setattr(processes, 'STARVED_S', 0.0)
    with started(COMPUTES) as (_, threads), pytest.raises(TooBusy, match='no turn'):
        threads.wait_until_quiet()


@pytest.mark.parametrize('program', [SLEEPS, COMPUTES])
def test_a_program_that_has_ended_is_quiet(program):
    """Nothing of it runs any more."""
    with started(program) as (process, threads):
        process.kill()
        process.wait()

        assert threads.wait_until_quiet()
