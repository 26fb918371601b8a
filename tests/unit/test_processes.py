"""What a program does, seen from outside."""

from __future__ import annotations

from contextlib import contextmanager
import os
import subprocess
import sys

import pytest

from autograder.errors import TooBusy
from autograder.sandboxes import processes
from autograder.sandboxes.processes import BUSY_S, Threads, wait_until_quiet

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
def started(program, *pipes):
    """Yield a program that has said its first word, and its threads."""
    argv = [sys.executable, '-c', program, *map(str, pipes)]
    with subprocess.Popen(argv, stdout=subprocess.PIPE, pass_fds=pipes) as process:
        threads = Threads(process.pid)
        try:
            assert process.stdout.readline() == b'x\n'
            yield process, threads
        finally:
            threads.close()
            process.kill()


# Hands on every byte it gets, for ever.
HANDS_ON = """
import os, sys
print('x', flush=True)
source, sink = map(int, sys.argv[1:])
while one := os.read(source, 1):
    os.write(sink, one)
"""


@contextmanager
def turns():
    """Yield two programs that hand one byte to and fro."""
    there, back = os.pipe(), os.pipe()
    with (
        started(HANDS_ON, there[0], back[1]) as (_, one),
        started(HANDS_ON, back[0], there[1]) as (_, other),
    ):
        os.write(there[1], b'.')
        yield one, other
    for end in (*there, *back):
        os.close(end)


def test_a_program_that_sleeps_is_quiet():
    """All of its threads wait for something."""
    with started(SLEEPS) as (_, threads):
        assert wait_until_quiet(threads)


def test_a_callback_on_another_thread_is_waited_for():
    """Quiet is when it is over, and what it did is done then."""
    with started(COMPUTES_FOR_A_WHILE) as (process, threads):
        assert wait_until_quiet(threads)
        assert process.stdout.readline() == b'done\n'
        assert threads.used_s() >= 0.03


def test_a_program_that_always_computes_is_left_alone():
    """After the processor time that is enough to tell, and not after wall time."""
    with started(COMPUTES) as (_, threads):
        before = threads.used_s()

        assert not wait_until_quiet(threads)
        assert threads.used_s() >= before + BUSY_S


def test_a_program_that_gets_no_processor_is_nobodys_mistake(monkeypatch):
    """Nothing is known about it then, so the run is repeated and not judged."""
    monkeypatch.setattr(processes, 'STARVED_S', 0.0)
    with started(COMPUTES) as (_, threads), pytest.raises(TooBusy, match='no turn'):
        wait_until_quiet(threads)


@pytest.mark.parametrize('program', [SLEEPS, COMPUTES])
def test_a_program_that_has_ended_is_quiet(program):
    """Nothing of it runs any more."""
    with started(program) as (process, threads):
        process.kill()
        process.wait()

        assert wait_until_quiet(threads)


def test_two_programs_that_take_turns_are_not_quiet():
    """Each sleeps while the other runs, so at no moment all of them do."""
    with turns() as (one, other):
        assert not wait_until_quiet(one, other)


@pytest.mark.parametrize('program', [SLEEPS, COMPUTES_FOR_A_WHILE])
def test_one_that_computes_does_not_hide_another(program):
    """The other one is waited for all the same."""
    with started(COMPUTES) as (_, busy), started(program) as (process, threads):
        assert not wait_until_quiet(busy, threads)
        if program == COMPUTES_FOR_A_WHILE:
            assert process.stdout.readline() == b'done\n'
