"""The first and last messages of a program are received, at the same times on any machine."""

import time
from xml.etree import ElementTree

import pytest

from autograder.exam.steps import Advance, Feed, Mark
from autograder.runs import observe
from autograder.sandboxes.sandbox import HERE

INT, STRING = 'std_msgs/msg/Int32', 'std_msgs/msg/String'
SECOND = 1_000_000_000
GRAIN_NS = 1_000_000

pytestmark = [pytest.mark.pipeline, pytest.mark.ros, pytest.mark.slow]


ENDS_SLOWLY = """
def make():
    node = Node('short')
    rclpy.spin_once(node, timeout_sec=1.0)
    import time
    time.sleep(0.2)  # at rest, as while threads are waited for
    raise SystemExit
"""


def test_what_follows_the_end_of_a_program_is_no_part_of_its_run(run):
    """The run ends with the program, however long the probe continues."""
    seen = run(ENDS_SLOWLY, Advance(1.0), Mark('late'))

    assert seen.end_reason == 'student_exited'
    assert seen.of('mark') == []
    assert seen.process['ended_ns'] == seen.of('end')[0]['clock_ns']


GOES_ON = """
def make():
    import threading, time
    def tell():
        while True:
            print(time.monotonic_ns(), flush=True)
            time.sleep(0.01)
    threading.Thread(target=tell, daemon=True).start()
    return Node('clockwork')
"""


def test_time_stands_still_while_the_grader_looks_at_what_still_runs(run, monkeypatch):
    """A grader that is slow to look finds the same processes and the same output."""
    look, times = observe._RunLoop._record_surroundings, []

    def look_late(loop):
        times.append(loop.clock.elapsed_ns)
        time.sleep(0.2)
        look(loop)
        times.append(loop.clock.elapsed_ns)

    monkeypatch.setattr(observe._RunLoop, '_record_surroundings', look_late)
    printed = run(GOES_ON, Advance(1.0)).process['stdout'].split()

    assert times[0] == times[1]
    assert int(printed[-1]) - int(printed[0]) <= times[0]


MANY = """
from rclpy.executors import SingleThreadedExecutor


def make():
    executor = SingleThreadedExecutor()
    for number in range(12):
        node = Node(f'node_{number:02}')
        node.get_logger().info('made')
        executor.add_node(node)
    executor.spin()
"""
LATER = """
from rclpy.executors import SingleThreadedExecutor


def make():
    executor = SingleThreadedExecutor()
    first = Node('first')

    def more():
        timer.cancel()
        second = Node('second')
        executor.add_node(second)
        second.get_logger().info('made')

    timer = first.create_timer(1.0, more)
    executor.add_node(first)
    executor.spin()
"""


class TestFirstLines:
    """The probe also receives lines that were logged before it discovered the node."""

    def test_first_lines_of_all_nodes_come_before_the_first_step(self, run):
        seen = run(MANY, Mark('steps'), Advance(0.25))

        assert {event['name'] for event in seen.logs()} == {f'node_{n:02}' for n in range(12)}
        assert seen.phase('steps').logs() == []

    def test_first_line_of_a_node_that_comes_later_is_at_its_time(self, run):
        """The first node's executor creates the second node exactly one second later."""
        seen = run(LATER, Advance(4.0))

        (line,) = seen.logs()
        assert 0 <= line['clock_ns'] - SECOND < GRAIN_NS


LAST_WORDS = """
def make():
    node = Node('last')
    publisher = node.create_publisher(Int32, '/out', 10)

    def speak():
        publisher.publish(Int32(data=7))
        node.destroy_node()
        raise SystemExit

    node.create_timer(1.0, speak)
    return node
"""


@pytest.mark.parametrize('number', range(3))
def test_last_message_of_a_program_that_ends_is_heard(run, number):
    """The end of the publisher must not be reported before its last message."""
    seen = run(LAST_WORDS, Advance(3.0), watch={'/out': INT})

    assert [event['data'] for event in seen.messages('/out')] == [{'data': 7}]
    assert seen.end_reason == 'student_exited'


def test_the_two_profiles_agree_but_for_port_and_announcements():
    """Fast DDS reads only one file, so common settings are written twice."""
    own = ('UnicastLocatorList', 'Announcement', 'Announcements')

    def words(name):
        tree = ElementTree.parse(HERE / name)
        for parent in list(tree.iter()):
            for child in [one for one in parent if one.tag.endswith(own)]:
                parent.remove(child)
        return [(one.tag, one.attrib, (one.text or '').strip()) for one in tree.iter()]

    assert words('fastdds.xml') == words('probe/probe.xml')


SHORT_QUEUE = """
def make():
    node = Node('short')
    publisher = node.create_publisher(Int32, 'heard', 10)
    node.create_subscription(Int32, 'numbers', publisher.publish, 1)
    return node
"""


def test_a_queue_of_one_keeps_the_newest_of_a_burst(run):
    """The whole burst arrives before the program's executor takes a message."""
    burst = Feed('/numbers', [{'data': number} for number in range(5)], burst=True)
    for _ in range(3):
        seen = run(SHORT_QUEUE, burst, feed={'/numbers': INT}, watch={'/heard': INT})

        assert [event['data'] for event in seen.messages('/heard')] == [{'data': 4}]
