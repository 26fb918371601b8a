"""The robot of the lessons, driven by real publishers in real kernels."""

import re

import pytest

pytest.importorskip('rclpy')

from live_kernels import execute, kernel, kernel_to_share  # noqa: F401 - fixtures

from autograder.simulated import TopicRecord
from roslab.errors import RoslabError
from roslab.robot import robot

pytestmark = pytest.mark.ros

DRIVER = """
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from roslab import listen, logs, robot, start, stop, stop_all, wait_until

driver = start(Node, name='driver')
go = Twist()
go.linear.x = 1.0
"""


def test_robot_obeys_stops_and_publishes_its_pose(kernel):
    """The attributes and the topic have the same pose."""
    kernel.run(DRIVER)
    out = kernel.run(
        'bot = robot()\n'
        'pose = listen("odom", Odometry)\n'
        'wheel = driver.create_publisher(Twist, "cmd_vel", 10)\n'
        'wheel.publish(go)\n'
        'wait_until(lambda: bot.x > 0.2, 60)\n'
        'wheel.publish(Twist())\n'
        'wait_until(lambda: len(bot.commands) == 2 and not bot.moving, 60)\n'
        'pose.clear(); pose.wait(2, 60)\n'
        'sent = pose.last.pose.pose\n'
        'print(sent.position.x == bot.x > 0.2, sent.orientation.w, pose.last.header.frame_id)'
    )

    assert (out.error, out.text) == (None, 'True 1.0 odom\n')


def test_robot_drives_into_the_wall_if_its_driver_falls_silent(kernel):
    """A silent driver does not stop the robot, but a missed deadline does."""
    kernel.run(DRIVER)
    out = kernel.run(
        'bot = robot()\n'
        'wheel = driver.create_publisher(Twist, "cmd_vel", 10)\n'
        'wheel.publish(go); stop(driver)\n'
        'wait_until(lambda: bot.at_wall, 60)\n'
        'print(round(bot.x, 1), bot.commands[-1].speed)'
    )
    careful = kernel.run(
        'driver = start(Node, name="driver")\n'
        'promise = QoSProfile(depth=1, deadline=Duration(seconds=0.3))\n'
        'bot = robot(qos=promise)\n'
        'wheel = driver.create_publisher(Twist, "cmd_vel", promise)\n'
        'wheel.publish(go)\n'
        'wait_until(lambda: bot.x > 0.1 and not bot.moving, 60)\n'
        'print(bot.at_wall, "a missed deadline stopped it 1 time" in str(bot))'
    )

    assert (out.error, out.text) == (None, '4.8 1.0\n')
    assert (careful.error, careful.text) == (None, 'False True\n')


def test_robot_names_the_policy_of_a_refused_publisher(kernel):
    kernel.run(DRIVER)
    out = kernel.run(
        'bot = robot()\n'
        'weak = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)\n'
        'wheel = driver.create_publisher(Twist, "cmd_vel", weak)\n'
        'wait_until(lambda: "RELIABILITY" in str(bot), 60)\n'
        'wheel.publish(go)\n'
        'print(len(bot.commands), bot.moving)'
    )

    assert out.error is None
    assert '0 False' in out.text.splitlines()  # before or after the node's warning


def test_robot_of_an_earlier_call_is_replaced_and_stays_where_it_is(kernel):
    kernel.run(DRIVER)
    out = kernel.run(
        'old = robot()\n'
        'wheel = driver.create_publisher(Twist, "cmd_vel", 10)\n'
        'wheel.publish(go)\n'
        'wait_until(lambda: old.x > 0.1, 60)\n'
        'new = robot()\n'
        'left = old.x\n'
        'wait_until(lambda: driver.count_subscribers("cmd_vel") == 1, 60)\n'
        'wheel.publish(go)\n'
        'wait_until(lambda: new.x > 0.1, 60)\n'
        'print(old.x == left)\n'
        'stop_all(); print(new.x == new.x)'
    )

    assert (out.error, out.text) == (None, 'True\nTrue\n')


def test_executed_notebook_keeps_the_picture_of_what_arrived(tmp_path):
    drive = (
        'wheel = driver.create_publisher(Twist, "cmd_vel", 10)\n'
        'wheel.publish(go)\nwait_until(lambda: bot.at_wall, 60)\nbot'
    )
    notebook = execute([DRIVER, 'bot = robot()', drive, 'stop_all()'], tmp_path)
    outputs = [cell.outputs for cell in notebook.cells]
    drawn = [one for cell in outputs[1:3] for one in cell if 'text/html' in one.data]

    assert len(drawn) == 2
    for shown in drawn:
        assert '1 command arrived' in shown.data['text/plain']
        assert 'at a wall' in shown.data['text/plain']
        assert re.search(r'<desc[^>]*>The robot is at x 4\.8', shown.data['text/html'])


def test_robot_replays_a_simulation():
    """The recorded commands give the pose; a different type is refused."""
    go = {'linear': {'x': 0.5}, 'angular': {'z': 0.0}}
    stop = {'linear': {'x': 0.0}}
    record = TopicRecord(
        '/cmd_vel', 'geometry_msgs/msg/Twist', (1.0, 3.0), (go, stop), seconds=5.0
    )
    driven = robot(record)

    assert (round(driven.x, 6), driven.moving, len(driven.commands)) == (1.0, False, 2)
    with pytest.raises(RoslabError, match='expected commands of type geometry_msgs/msg/Twist'):
        robot(TopicRecord('/chatter', 'std_msgs/msg/String', (), (), seconds=1.0))
