"""The time without progress after which a run ends."""

from types import SimpleNamespace

import pytest

from autograder.runs import watchdog
from autograder.sandboxes.confinement import Limits

PROGRAM, PROBE = 1, 2


@pytest.fixture
def look(monkeypatch):
    """Return a function that polls processes in a state a number of times, 0.1 s apart."""
    clock = SimpleNamespace(now=0.0, jumps=0)
    state = {}
    printed = [0]
    monkeypatch.setattr(watchdog.time, 'monotonic', lambda: clock.now)
    monkeypatch.setattr(watchdog, 'states', lambda pid: state[pid])
    monkeypatch.setattr(watchdog, 'usage', lambda pid: (0, 0.0))
    monkeypatch.setattr(watchdog, 'used_ns', lambda pid: 0)
    ready = [1]
    monkeypatch.setattr(watchdog, 'ready_to_run', lambda: ready[0])
    monkeypatch.setattr(watchdog.os, 'cpu_count', lambda: 2)
    process = SimpleNamespace(poll=lambda: None)
    student = SimpleNamespace(
        pids=(PROGRAM,), process=process, released=True, files=lambda: (0, 0), home=None
    )
    dog = watchdog.Watchdog(student, (PROBE,), Limits(), clock, builds=False)

    def look(times: int, program: bytes, probe: bytes, prints: int = 0, threads: int = 1) -> str:
        ready[0] = threads
        state.update({PROGRAM: program, PROBE: probe})
        for _ in range(times):
            clock.now += 0.1
            printed[0] += prints
            if said := dog.look(recorded=0, printed=printed[0], begun=True):
                return said
        return ''

    return look


def test_a_program_that_waits_outside_the_clock_has_a_third_of_a_second(look):
    """Three polls take less than that, the fourth takes more."""
    assert look(1, b'S', b'S') == ''  # the first poll sees all progress so far
    assert look(2, b'S', b'S') == ''
    assert look(2, b'S', b'S') == 'waits_outside'


def test_a_probe_that_was_stopped_leaves_the_program_its_own_patience(look):
    """The second before the probe continues is not charged to the program."""
    assert look(20, b'S', b'T') == ''
    assert look(2, b'S', b'S') == ''
    assert look(2, b'S', b'S') == 'waits_outside'


def test_a_program_that_waits_for_a_disk_has_three_seconds(look):
    """A program that waits for a child of vfork looks the same."""
    assert look(30, b'D', b'S') == ''
    assert look(3, b'D', b'S') == 'waits_outside'


def test_a_program_that_waits_on_a_busy_machine_has_three_seconds(look):
    assert look(30, b'S', b'S', threads=3) == ''
    assert look(3, b'S', b'S', threads=3) == 'waits_outside'


def test_a_program_whose_output_is_read_slowly_does_not_wait_outside(look):
    """More was read than a pipe holds, so the program did write; a few bytes prove nothing."""
    assert look(20, b'S', b'S', prints=100_000) == ''
    assert look(20, b'S', b'S', prints=10) == 'waits_outside'
