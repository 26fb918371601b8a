"""The budgets of real time for waiting while no process of a run computes."""

from itertools import count
from types import SimpleNamespace

import pytest

from autograder.runs import watchdog
from autograder.sandboxes.confinement import Limits
from autograder.sandboxes.processes import Running, Usage

PROGRAM, PROBE = 1, 2
FOR_STILL, FOR_IDLE, FOR_20_S = 8, 51, 401


@pytest.fixture
def world(monkeypatch):
    """Return a simulated machine on which nothing computes, with a watchdog."""
    world = SimpleNamespace(now=0.0, used_s=0.0, virtual_s=0.0, children={}, disk=False)
    world.state = {PROGRAM: b'S', PROBE: b'S'}
    monkeypatch.setattr(watchdog.time, 'monotonic', lambda: world.now)
    monkeypatch.setattr(watchdog, 'disk_is_busy', lambda: world.disk)

    def usage(pid):
        used_s, children = (world.used_s, world.children) if pid == PROGRAM else (0.0, {})
        return Usage(0, 0.0, {pid: Running(used_s, world.now, world.state[pid]), **children})

    monkeypatch.setattr(watchdog, 'usage', usage)
    student = SimpleNamespace(
        pids=(PROGRAM,),
        process=SimpleNamespace(poll=lambda: None),
        released=True,
        files=lambda: (0, 0),
        home=None,
    )
    world.dog = watchdog.Watchdog(student, (PROBE,), Limits(), builds=False)

    def look(times: int, program: bytes = b'S', begun: bool = True, every_s: float = 0.05) -> str:
        world.state[PROGRAM] = program
        for _ in range(times):
            world.now += every_s
            if said := world.dog.look(printed=0, begun=begun, virtual_s=world.virtual_s):
                return said
        return ''

    world.look = look
    return world


@pytest.mark.parametrize(
    ('program', 'probe', 'disk', 'looks'),
    [
        # Nothing can happen on the virtual clock any more; a program can also stop itself.
        (b'S', b'S', False, FOR_STILL),
        (b'T', b'S', False, FOR_STILL),
        # The program waits for a child after vfork, or for a disk, which the kernel counts.
        (b'D', b'S', False, FOR_IDLE),
        (b'D', b'S', True, FOR_20_S - 1),
        # A person who pauses or debugs the probe must not cost points at once.
        (b'S', b'T', False, FOR_IDLE),
        (b'S', b't', False, FOR_IDLE),
    ],
)
def test_time_without_computing_depends_on_what_all_threads_wait_for(
    world, program, probe, disk, looks
):
    world.disk, world.state[PROBE] = disk, probe

    assert world.look(looks - 1, program) == ''
    assert world.look(1, program) == 'waits_outside'


def test_short_waits_outside_the_clock_add_up(world):
    looks = 0
    while world.look(1) == '':
        world.used_s += 0.0001
        looks += 1

    assert looks == pytest.approx(FOR_IDLE, abs=2)


def test_computing_renews_no_budget(world):
    for _ in range(FOR_STILL // 2 - 1):
        assert world.look(2) == ''
        assert world.look(1, b'R') == ''
    assert world.look(3) == 'waits_outside'


def test_a_program_that_computes_or_waits_for_a_processor_uses_no_budget(world):
    """A program that waits at the moment of each check may have computed between the checks."""
    assert world.look(2 * FOR_IDLE, b'R') == ''
    for _ in range(2 * FOR_IDLE):
        world.used_s += 0.05
        assert world.look(1) == ''
    assert world.look(FOR_STILL) == 'waits_outside'


def test_a_program_may_use_a_quarter_of_the_virtual_time_too(world):
    """A program that looks for messages every millisecond uses less, however long the run is."""
    assert world.look(1) == ''
    world.used_s, world.virtual_s = 94.9, 300.0
    assert world.look(1, b'R') == ''
    world.used_s = 95.1
    assert world.look(1, b'R') == 'cpu_limit'


@pytest.mark.parametrize(('used_s', 'looks'), [(0.02, 400), (0.01, 800)])
def test_each_child_that_nobody_reaps_counts_for_the_gap_in_which_it_is_seen(world, used_s, looks):
    """A new child every 50 ms, which has computed all or half of its 25 ms so far: 20 s in all."""
    for number in count(1):
        world.children = {PROBE + number: Running(used_s, 0.025, states=b'R')}
        if world.look(1) == 'cpu_limit':
            break

    assert number == pytest.approx(looks, abs=1)


def test_a_delay_of_the_grader_is_not_charged_to_the_program(world):
    assert world.look(FOR_STILL - 1, every_s=3.0) == ''
    world.children = {PROBE + number: Running(0.02, 0.025, states=b'R') for number in (1, 2)}
    world.look(1, every_s=100.0)
    assert world.dog.cpu_s == pytest.approx(0.1)


def test_processor_time_of_a_process_that_waits_is_not_an_estimate(world):
    """A compiler's driver computes for milliseconds and then waits for the compiler."""
    for number in range(100):
        world.children = {PROBE + 1 + number: Running(0.004, 0.04, states=b'S')}
        world.look(1, b'R')
    assert world.dog.cpu_s == 0.0


def test_a_build_has_its_own_budget(world):
    world.dog.builds = True
    assert world.look(FOR_20_S - 2, begun=False) == ''
    assert world.look(FOR_STILL - 2) == ''
    assert world.look(2) == 'waits_outside'


def test_the_setup_of_the_sandbox_has_its_own_budget(world):
    world.dog.student.released = False
    assert world.look(FOR_20_S - 2, begun=False) == ''
    assert world.look(2, begun=False) == 'waits_outside'


def test_the_next_check_is_due_after_a_twentieth_of_a_second(world):
    world.look(1)
    assert world.dog.due_in_s() == pytest.approx(0.05)
    world.now += 0.06
    assert world.dog.due_in_s() == 0
