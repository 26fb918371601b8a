"""Steps of the probe, taken alone."""

from __future__ import annotations

import subprocess
import sys

import pytest

from autograder.runs.observe import HERE

pytestmark = [pytest.mark.ros]

# A clock of its own: what each of the probe's acts takes is given, so the machine decides nothing.
STEPPING = f"""
import sys
from types import SimpleNamespace
sys.path[:0] = [{str(HERE / 'probe')!r}, {str(HERE / 'inside')!r}]
import probe_steps

class Probe:
    clock_ns, deaf, student_exited, own_time = None, set(), False, False
    now = patience_s = 0.0
    look_s = answer_s = 0.0
    def __init__(self, **facts):
        self.__dict__.update(facts)
        self.ticks = []
        probe_steps.time = SimpleNamespace(monotonic=lambda: self.now)
    def pass_time(self, seconds):
        self.now += seconds
        self.patience_s += seconds
    def emit(self, *_, **__): pass
    def drain(self): pass
    def tick(self, nanoseconds):
        self.pass_time(0.0001)
        self.ticks.append(nanoseconds / 1e9)
    def barrier(self, rounds): self.pass_time(self.answer_s)
    def spin(self, seconds):
        # The probe hears its own tick, so that waiting for news returns at once.
        self.pass_time(min(self.look_s or seconds, seconds))

def advance(watch_s, **facts):
    probe = Probe(**facts)
    try:
        probe_steps.advance(probe, {{'watch_s': watch_s}}, False)
    except probe_steps.Stop as stop:
        print(stop)
    return probe

def longest(probe):
    ticks = probe.ticks
    return max(later - earlier for earlier, later in zip([0.0, *ticks], ticks))
"""


def stepping(program: str) -> list[str]:
    """Return what a program with steps prints, line by line."""
    ran = subprocess.run(
        [sys.executable, '-c', STEPPING + program],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return ran.stdout.split('\n')[:-1]


class TestWatchedInRealTime:
    """Programs that keep their own time, or whose nodes do in part."""

    def test_hears_a_hundred_ticks_a_second_at_most(self):
        """Thousands would cost more of the processor than what is watched."""
        (said,) = stepping('probe = advance(0.5, look_s=0.001); print(len(probe.ticks))')

        assert 45 <= int(said) <= 50

    @pytest.mark.parametrize(('pause_s', 'said'), [(0.25, []), (0.35, ['too_busy'])])
    @pytest.mark.parametrize('act', ['emit', 'tick', 'spin'])
    def test_a_stalled_probe_gives_no_evidence(self, act, pause_s, said):
        """Its pause would be taken for one that the program makes, wherever it comes."""
        late = f'Probe.{act} = lambda self, *_, **__: self.pass_time({pause_s})'
        assert stepping(f'{late}; advance(5.0)') == said

    def test_nodes_that_follow_the_clock_are_never_late(self):
        """The next tick waits for the answer to the last one, and is a short one."""
        slow, end = map(
            float,
            stepping(
                'probe = advance(3.0, own_time=True, answer_s=0.15)\n'
                'print(longest(probe)); print(probe.ticks[-1])'
            ),
        )

        assert slow <= 0.1 + 1e-6
        assert 3.0 <= end < 3.2

    def test_the_clock_keeps_real_time_where_they_keep_up(self):
        """A node with a clock of its own beside them then seems neither fast nor slow."""
        behind, end = map(
            float,
            stepping(
                'probe = advance(3.0, own_time=True, answer_s=0.004)\n'
                'print(probe.now - probe.ticks[-1]); print(probe.ticks[-1])'
            ),
        )

        assert abs(behind) < 0.05
        assert 3.0 <= end < 3.1

    def test_one_that_takes_seconds_to_answer_is_not_waited_for_without_end(self):
        """Twice the time that it was to be watched, in its own time."""
        took, end = map(
            float,
            stepping(
                'probe = advance(3.0, own_time=True, answer_s=1.0)\n'
                'print(probe.now); print(probe.ticks[-1])'
            ),
        )

        assert 6.0 <= took < 7.1
        assert end < 1.0


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
