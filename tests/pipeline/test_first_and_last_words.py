"""What a run owes to no machine: first and last words are heard, and other clocks are noticed."""

from __future__ import annotations

from xml.etree import ElementTree

import pytest

from autograder.runs.scenario import Advance
from autograder.sandboxes.sandbox import HERE

INT = 'std_msgs/msg/Int32'

pytestmark = [pytest.mark.pipeline, pytest.mark.ros, pytest.mark.slow]


ENDS_SLOWLY = """
def make():
    node = Node('short')
    rclpy.spin_once(node)
    import time
    time.sleep(0.2)  # at rest, as while threads are waited for
    raise SystemExit
"""


def test_a_program_that_answers_once_and_ends_has_shown_nothing(run):
    """While it ends it may be at rest, and its node in the graph for some milliseconds more."""
    seen = run(ENDS_SLOWLY, Advance(1.0))

    assert [event['answered'] for event in seen.of('barrier')] == [True]
    assert seen.end_reason == 'student_exited'
    assert seen.of('graph') == []


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
    """What was logged before we met is fetched, and that takes its time."""

    def test_first_lines_of_all_nodes_come_before_the_first_step(self, run):
        """Nothing begins while one of them is on its way."""
        seen = run(MANY, Advance(0.25))

        assert {event['name'] for event in seen.logs()} == {f'node_{n:02}' for n in range(12)}
        assert {event['clock_ns'] for event in seen.logs()} == {None}

    def test_first_line_of_a_node_that_comes_later_is_at_its_time(self, run):
        """The clock waits for it as it does for the first ones."""
        seen = run(LATER, Advance(4.0))

        (line,) = seen.logs()
        assert line['clock_ns'] == 1_100_000_000


ON_ITS_OWN = """
import threading


def make():
    node = Node('own')
    publisher = node.create_publisher(Int32, '/out', 10)

    def go_on():
        again = threading.Timer(0.3, go_on)
        again.daemon = True
        again.start()
        publisher.publish(Int32())
        node.get_logger().info('out')

    go_on()
    return node
"""
BY_ITS_TIMER = """
def make():
    node = Node('timed')
    publisher = node.create_publisher(Int32, '/out', 10)
    node.create_timer(1.0, lambda: publisher.publish(Int32()))
    return node
"""


class TestStandingStill:
    """Who publishes while no time passes keeps a time of its own."""

    def test_program_that_goes_on_is_watched_in_wall_time(self, run):
        """It answers, and so would else be led through simulated time in no time."""
        seen = run(ON_ITS_OWN, Advance(9.0, watch_s=1.0), watch={'/out': INT}, stand_still_s=1.0)

        assert [event['sources'] for event in seen.of('other_clock')] == [['/out']]
        assert [event['seconds'] for event in seen.of('wall_time')] == [1.0]
        assert [event['answered'] for event in seen.of('barrier')] == [True]
        assert len(seen.messages('/out')) > 2

    def test_lines_count_where_no_topic_is_watched(self, run):
        """An exam about log lines asks for nothing else."""
        seen = run(ON_ITS_OWN, Advance(9.0, watch_s=0.1), stand_still_s=1.0)

        assert seen.in_wall_time
        assert seen.by_another_clock('own')
        assert not seen.by_another_clock('other')

    @pytest.mark.parametrize('watch', [{}, {'/out': INT}, {'/other': INT}])
    def test_program_that_waits_is_led_through_simulated_time(self, run, watch):
        """Nothing is due while the clock stands still; after the last time all is known."""
        steps = Advance(3.0), Advance(3.0)

        seen = run(BY_ITS_TIMER, *steps, watch=watch, stand_still_s=0.2)

        assert not seen.in_wall_time
        assert not seen.goes_on_alone
        assert len(seen.messages('/out')) == (2 if '/out' in watch else 0)
        assert seen.end_reason == 'follows_the_clock'


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


@pytest.mark.parametrize('number', range(6))
def test_last_message_of_a_program_that_ends_is_heard(run, number):
    """The news that its publisher is gone must not overtake it."""
    seen = run(LAST_WORDS, Advance(3.0), watch={'/out': INT})

    assert [event['data'] for event in seen.messages('/out')] == [{'data': 7}]
    assert seen.end_reason == 'student_exited'


def test_the_two_profiles_agree_but_for_the_port():
    """What both sides need is written twice, as Fast DDS reads one file."""

    def words(name):
        tree = ElementTree.parse(HERE / name)
        for parent in list(tree.iter()):
            for child in [one for one in parent if one.tag.endswith('UnicastLocatorList')]:
                parent.remove(child)
        return [(one.tag, one.attrib, (one.text or '').strip()) for one in tree.iter()]

    assert words('fastdds.xml') == words('probe/probe.xml')
