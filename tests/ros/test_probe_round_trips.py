"""Round trips prove what the probe's barriers promise, with real nodes on both sides."""

from __future__ import annotations

from contextlib import ExitStack
import subprocess
import sys

import pytest

from autograder.runs.observe import HERE
from tests.own_domain import own_domain

pytestmark = [pytest.mark.ros]

# Both sides in one process, each in a context of its own; the other side spins in a thread.
WORLD = f"""
import sys
sys.path[:0] = [{str(HERE / 'probe')!r}, {str(HERE / 'inside')!r}]
from threading import Thread
import rclpy
from probe_round_trips import RoundTrips, Stop
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

class Probe:
    patience_s, student_exited, drained = 0.0, False, 0
    def __init__(self):
        self.context = Context()
        rclpy.init(context=self.context, domain_id=int(sys.argv[1]))
        self.node = rclpy.create_node('asking', context=self.context, enable_rosout=False)
        self.node.create_subscription(String, 'watched', print, 10)
    def hear_grader(self, seconds):
        self.patience_s += 0.05
    def drain(self):
        self.drained += 1
        for each in self.node.subscriptions:
            each.handle.take_message(each.msg_type, False)

there = Context()
rclpy.init(context=there, domain_id=int(sys.argv[1]))
asked = rclpy.create_node('asked', context=there)
executor = SingleThreadedExecutor(context=there)
executor.add_node(asked)
probe = Probe()
trips = RoundTrips(probe)

def spin():
    Thread(target=executor.spin, daemon=True).start()

"""


def ran(program: str) -> str:
    """Run a program in that world and return what it printed."""
    end = '\nimport os; sys.stdout.flush(); os._exit(0)\n'
    with ExitStack() as until:
        argv = [sys.executable, '-c', WORLD + program + end, str(own_domain(until))]
        pipe = subprocess.PIPE
        return subprocess.run(argv, text=True, check=True, timeout=290, stdout=pipe).stdout


def test_after_one_round_more_than_messages_all_of_them_are_handled():
    """Several questions may be on their way at once, and still each answer is a pass."""
    printed = ran("""
heard, passes = [], []
asked.create_subscription(String, 'told', heard.append, 10)
telling = probe.node.create_publisher(String, 'told', 10)
spin()
assert trips.ask('/asked', 1, 60.0)
while not telling.get_subscription_count():
    trips.ask('/asked', 1, 60.0)
for told in (1, 2, 5, 9):
    for _ in range(25):
        heard.clear()
        for number in range(told):
            telling.publish(String(data=str(number)))
        answered = trips.ask('/asked', told + 1, 60.0)
        passes.append(answered and len(heard) == told)
print(len(passes), all(passes))
""")

    assert printed == '100 True\n'


def test_a_node_that_nobody_spins_gives_no_answer_and_does_not_block():
    """The patience is the program's own time, which the grader tells."""
    printed = ran("""
print(trips.ask('/asked', 2, 1.0), trips.ask('/nobody', 1, 0.3))
spin()
print(trips.ask('/asked', 3, 60.0))
""")

    assert printed == 'False False\nTrue\n'


def test_the_end_of_the_program_ends_the_waiting():
    """Nobody will answer any more."""
    printed = ran("""
probe.student_exited = True
try:
    trips.ask('/asked', 1, 60.0)
except Stop as stop:
    print(stop)
""")

    assert printed == 'student_exited\n'


def test_messages_are_taken_while_an_answer_is_waited_for():
    """A flood would else overflow the reader; our own ticks that come back wake nobody."""
    printed = ran("""
probe.node.create_subscription(String, '/clock', print, 10)
tick = probe.node.create_publisher(String, '/clock', 10)
tick.publish(String())
trips.ask('/asked', 1, 0.3)
print(probe.drained)
probe.node.create_subscription(String, 'flood', print, 10)
flood = asked.create_publisher(String, 'flood', 10)
asked.create_timer(0.001, lambda: flood.publish(String()))
spin()
while not probe.drained:
    trips.ask('/asked', 1, 60.0)
print(probe.drained > 0)
""")

    assert printed == '0\nTrue\n'


def test_clients_that_were_forgotten_are_made_anew():
    """Announcements are in order, so the answer to a new client proves all earlier ones."""
    printed = ran("""
spin()
print(trips.ask('/asked', 1, 60.0), len(list(probe.node.clients)))
trips.forget()
print(len(list(probe.node.clients)))
print(trips.ask('/asked', 1, 60.0), len(list(probe.node.clients)))
""")

    assert printed == 'True 1\n0\nTrue 1\n'
