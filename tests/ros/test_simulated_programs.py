"""Programs on the virtual clock without an exam: exact times, bursts, late subscriptions, ends."""

import re

import pytest
from std_msgs.msg import Float64

from autograder.errors import UsageError
from autograder.simulation.virtual_time import virtual_time  # noqa: F401
from roslab.errors import NotHereError
from roslab.live_plot import Plot
from roslab.package_files import learner_package
from roslab.simulating import simulate
from roslab.timeline_picture import timeline

pytestmark = [pytest.mark.ros, pytest.mark.slow]

TALKER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import String

class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.create_timer(1.0, self.on_timer)

    def on_timer(self):
        self.publisher.publish(String(data='hello'))

def main():
    rclpy.init()
    rclpy.spin(Talker())

if __name__ == '__main__':
    main()
"""
DOUBLE = """
import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64

class Double(Node):
    def __init__(self):
        super().__init__('double')
        kept = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(Float64, 'double', kept)
        self.create_subscription(Float64, 'number', self.on_number, 10)

    def on_number(self, message):
        if message.data > 99.0:
            raise ValueError('too large')
        self.get_logger().warning(f'got {message.data}')
        self.publisher.publish(Float64(data=2 * message.data))

rclpy.init()
rclpy.spin(Double())
"""


@pytest.fixture
def program(tmp_path):
    """Return a function that saves a program and returns its path."""

    def save(text):
        path = tmp_path / 'node.py'
        path.write_text(text, encoding='utf-8')
        return path

    return save


def numbers(*pairs):
    """Return inputs: pairs of a second and a number."""
    return {'number': [(at_s, {'data': float(value)}) for at_s, value in pairs]}


def test_hour_of_a_publisher_has_a_message_at_each_second(virtual_time, program):
    """No message is early, late or lost."""
    run = virtual_time(program(TALKER), seconds=3600)

    assert run.times('chatter') == [float(second) for second in range(1, 3601)]
    assert {message.data for message in run.messages('chatter')} == {'hello'}
    assert (run.reason, run.seconds) == ('complete', 3600.0)


def test_burst_arrives_at_one_instant_and_two_runs_are_equal(virtual_time, program):
    """Messages arrive in the order in which they were sent, in each run."""
    inputs = numbers(*((1, value) for value in range(8)), (2, 20))
    first, second = (virtual_time(program(DOUBLE), 5, inputs=inputs) for _ in range(2))

    assert [one.data for one in first.messages('double')] == [0, 2, 4, 6, 8, 10, 12, 14, 40]
    assert first.times('double') == [1.0] * 8 + [2.0]
    assert [line.text for line in first.logged('WARN')][-1] == 'got 20.0'
    assert first.sent['/number'].times == (*[1.0] * 8, 2.0)
    assert first == second


def test_late_subscription_receives_the_stored_messages(virtual_time, program):
    """Then the subscription receives the new messages, each at its time."""
    inputs = numbers(*((second, second) for second in range(1, 8)))
    run = virtual_time(program(DOUBLE), 10, inputs=inputs, late={'double': 5.5})

    assert run.late['/double'].times == (5.5, 5.5, 5.5, 6.0, 7.0)
    assert [message.data for message in run.late['/double']] == [6.0, 8.0, 10.0, 12.0, 14.0]
    assert run.sent['/number'].times == tuple(float(second) for second in range(1, 8))


def test_crash_ends_the_simulation_and_names_the_exception(virtual_time, program):
    """The result contains everything before the crash."""
    run = virtual_time(program(DOUBLE), 10, inputs=numbers((1, 5), (3, 100)))

    assert run.times('double') == [1.0]
    assert (run.reason, run.exit) == ('student_exited', 1)
    assert run.ended.endswith('ValueError: too large')


def test_limit_ends_the_simulation_and_keeps_what_came_before(virtual_time, program):
    """The example is the limit on printed text."""
    endless = """
        self.count = getattr(self, 'count', 0) + 1
        while self.count == 4:
            print('x' * 100_000)
"""
    text = TALKER.replace(
        '(self):\n        self.publisher.', f'(self):{endless}        self.publisher.'
    )
    run = virtual_time(program(text), seconds=3600)

    assert run.times('chatter') == [1.0, 2.0, 3.0]
    assert (run.reason, run.seconds) == ('output_limit', 3.0)


def test_topic_that_appears_later_is_recorded(virtual_time, program):
    """An input makes the program create the publisher."""
    later = """
import rclpy
from std_msgs.msg import Empty, String
rclpy.init()
node = rclpy.create_node('later')

def answer(_):
    publisher = node.create_publisher(String, 'answer', 10)
    node.create_timer(1.0, lambda: publisher.publish(String(data='here')))

node.create_subscription(Empty, 'start', answer, 10)
rclpy.spin(node)
"""
    run = virtual_time(program(later), 10, inputs={'start': [(5, {})]})

    assert run.times('answer') == [6.0, 7.0, 8.0, 9.0, 10.0]


def test_field_that_a_message_lacks_is_named(virtual_time, program):
    """The error blames the inputs, not the grader."""
    with pytest.raises(UsageError, match=r"inputs: a message does not fit .* no attribute 'dat'"):
        virtual_time(program(DOUBLE), 5, inputs={'number': [(1, {'dat': 1.0})]})


def test_saved_cell_is_simulated_and_drawn(tmp_path, monkeypatch):
    """The pictures for live messages also show a simulation."""
    monkeypatch.chdir(tmp_path)
    folder = learner_package().folder / learner_package().name
    folder.mkdir(parents=True)
    (folder / 'double.py').write_text(DOUBLE, encoding='utf-8')
    run = simulate('double', seconds=60, inputs={'number': [(5, Float64(data=4.0))]})

    assert (run.messages('double'), run.times('double')) == ([Float64(data=8.0)], [5.0])
    assert re.search(r'/number \(input\) +1 +- +5\.00', str(timeline(run)))
    assert '5.00 s  8' in str(Plot(run['double'], 'data'))
    with pytest.raises(NotHereError, match="Did you mean 'double'"):
        simulate('doubel', seconds=1)
