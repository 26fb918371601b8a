"""A program sees the same number of processors on every machine."""

SEEN = """
import json, multiprocessing, os
print(json.dumps([os.cpu_count(), multiprocessing.cpu_count(), sorted(os.sched_getaffinity(0))]))
os.sched_setaffinity(0, {0, 1})
print(json.dumps(sorted(os.sched_getaffinity(0))))
"""
NOT_MOVED = """
import json, os, time
before = open('/proc/self/status').read()
os.sched_setaffinity(0, {0})
time.sleep(1)
lines = open('/proc/self/status').read().split('\\n')
print(json.dumps(all(line in before for line in lines if 'Cpus_allowed' in line)))
"""


def test_a_program_sees_four_processors(on_clock):
    """A MultiThreadedExecutor has as many threads as the program sees processors."""
    every = [0, 1, 2, 3]
    assert on_clock(SEEN) == [[[4, 4, every], every]]


def test_a_program_cannot_choose_its_processor(on_clock):
    """The call succeeds and has no effect."""
    assert on_clock(NOT_MOVED) == [[True]]
