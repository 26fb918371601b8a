"""Steps of the probe, taken alone."""

from __future__ import annotations

import subprocess
import sys

import pytest

from autograder.runs.observe import HERE

pytestmark = [pytest.mark.ros]

# The probe hears its own tick, so that waiting for news returns at once; here it always does.
PROGRAM = f"""
import sys
sys.path[:0] = [{str(HERE / 'probe')!r}, {str(HERE / 'inside')!r}]
from probe_steps import advance

class Probe:
    clock_ns, deaf, student_exited, ticks = None, set(), False, 0
    def emit(self, *_, **__): pass
    def spin(self, seconds): pass
    def tick(self, nanoseconds): self.ticks += 1

probe = Probe()
advance(probe, {{'watch_s': 0.5}}, False)
print(probe.ticks)
"""


def test_a_program_that_keeps_its_own_time_hears_a_hundred_ticks_a_second_at_most():
    """Thousands would cost more of the processor than what is watched."""
    ran = subprocess.run(
        [sys.executable, '-c', PROGRAM], capture_output=True, text=True, check=True, timeout=60
    )

    assert 1 <= int(ran.stdout) <= 50


# A tick of our own makes no event; a topic that is written faster than read never ends.
WAITING = f"""
import sys
sys.path[:0] = [{str(HERE / 'probe')!r}, {str(HERE / 'inside')!r}]
from contextlib import nullcontext
from itertools import count
import probe

class Handle(nullcontext):
    def __init__(self, waiting):
        super().__init__()
        self.waiting = iter(waiting)
    def take_message(self, msg_type, raw):
        message = next(self.waiting, None)
        return None if message is None else (message, {{}})

class Subscription:
    msg_type = None
    def __init__(self, waiting):
        self.handle, self.heard = Handle(waiting), []
        self.callback = self.heard.append

class Watching:
    pass

watching = Watching()
watching.node = Watching()
ticks, topic, flood = Subscription([1]), Subscription([1, 2, 3]), Subscription(count(1))
watching.node.subscriptions = [ticks, topic]
probe.Probe.drain(watching)
print(ticks.heard, topic.heard)
watching.node.subscriptions = [flood]
probe.Probe.drain(watching)
print(len(flood.heard))
"""


def test_all_that_has_arrived_is_handled_whether_it_makes_an_event_or_not():
    """What is left over belongs to the next step of the clock, and a stamp would seem stale."""
    ran = subprocess.run(
        [sys.executable, '-c', WAITING], capture_output=True, text=True, check=True, timeout=60
    )
    first, second = ran.stdout.splitlines()

    assert first == '[1] [1, 2, 3]'
    assert 100 <= int(second) <= 1000


ASKING = f"""
import sys
sys.path[:0] = [{str(HERE / 'probe')!r}, {str(HERE / 'inside')!r}]
import probe

class Asking:
    patience_s, spare_s = 10.0, probe.SPARE_S
    def __init__(self):
        self.asked, self.unreachable, self.given, self.trips = set(), set(), [], self
    def emit(self, *_, **__): pass
    def ask(self, name, rounds, patience_s):
        self.given.append(round(patience_s, 3))
        self.patience_s += patience_s  # nobody answers
        return False

asking = Asking()
for number in range(10):
    probe.Probe.ask_first(asking, str(number), 13.0 - asking.patience_s)
print(asking.given, len(asking.unreachable))
"""


def test_a_node_asked_late_has_time_to_be_asked_again():
    """A first question may be lost; but a crowd of silent nodes is not waited for one by one."""
    ran = subprocess.run(
        [sys.executable, '-c', ASKING], capture_output=True, text=True, check=True, timeout=60
    )

    assert ran.stdout.strip() == '[3.0, 1.2, 1.2, 1.2, 1.2, 0.6, 0.1, 0.1, 0.1, 0.1] 10'
