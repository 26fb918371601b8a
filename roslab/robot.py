"""
A small robot that obeys commands on ``cmd_vel``, publishes its pose and shows the commands.

Its motors keep the last command until another one arrives, like those of many real robots.
"""

from collections.abc import Callable
import math
import threading
import time

from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind, QoSProfile

from autograder.simulated import TopicRecord
from roslab.errors import RoslabError
from roslab.interrupts import HeldInterrupts
from roslab.live_picture import LivePicture
from roslab.robot_picture import track_html, track_text
from roslab.robot_track import DEADLINE, Happened, Track
from roslab.session import session

NAME = 'robot'
_TWIST = 'geometry_msgs/msg/Twist'
_PERIOD_S = 0.1


class Robot(LivePicture):
    """
    A robot in a room of 6 m by 3 m, from above; it starts at x = 0, y = 0, facing along x.

    :param clock: returns the time since the start [s]; None for a robot that no longer moves
    """

    def __init__(self, track: Track, clock: Callable[[], float] | None = None) -> None:
        super().__init__(NAME)
        self._clock = clock
        self._track = track
        self._using = threading.Lock()  # cells, callbacks and the drawing thread advance the track
        self.refused = ''

    @property
    def x(self) -> float:
        """Current position, ahead of the start [m]."""
        return self._now().pose.x

    @property
    def y(self) -> float:
        """Current position, to the left of the start [m]."""
        return self._now().pose.y

    @property
    def heading(self) -> float:
        """Current heading, anticlockwise from the x axis [rad]."""
        return self._now().pose.heading

    @property
    def moving(self) -> bool:
        """Return whether the robot is driving or turning."""
        return self._now().moving

    @property
    def at_wall(self) -> bool:
        """Return whether a wall stops the robot."""
        return self._now().at_wall

    @property
    def commands(self) -> list[Happened]:
        """The commands that arrived, oldest first."""
        return self._now().arrived

    def obey(self, command: Twist) -> None:
        """Obey a command that arrives now."""
        self._change(command.linear.x, command.angular.z)

    def stop_after_deadline(self) -> None:
        """Stop because no command arrived within the deadline; ignore consecutive misses."""
        if self._track.happened[-1:] and self._track.happened[-1].what == DEADLINE:
            return
        self._change(0.0, 0.0, DEADLINE)

    def _finish(self) -> None:
        """Keep the current pose from now on."""
        self._now()
        self._clock = None

    def _can_change(self) -> bool:
        return self._clock is not None

    def _change(self, speed: float, turn: float, *what: str) -> None:
        with HeldInterrupts(), self._using:
            if self._clock is not None:
                self._track.obey(self._clock(), speed, turn, *what)

    def _now(self) -> Track:
        with HeldInterrupts(), self._using:
            if self._clock is not None:
                self._track.advance(self._clock())
            return self._track

    def _newest(self) -> object:
        track = self._now()
        return track.pose, len(track.happened), self.refused

    def _html(self) -> str:
        return track_html(self._now(), self.refused)

    def __repr__(self) -> str:
        return track_text(self._now(), self.refused)


class RobotNode(Node):
    """
    A robot's node, which receives commands and publishes its pose on ``odom`` ten times a second.

    :param topic: topic of the commands, of type ``geometry_msgs/msg/Twist``
    :param qos: profile of the subscription; with a deadline, silence stops the robot
    """

    def __init__(self, topic: str, qos: QoSProfile | int) -> None:
        super().__init__(NAME)
        began = time.monotonic()
        self.robot = Robot(Track(), lambda: time.monotonic() - began)
        events = SubscriptionEventCallbacks(
            deadline=lambda _: self.robot.stop_after_deadline(),
            incompatible_qos=lambda event: self._refuse(event.last_policy_kind),
        )
        self.create_subscription(Twist, topic, self.robot.obey, qos, event_callbacks=events)
        self._odometry = self.create_publisher(Odometry, 'odom', 10)
        self.create_timer(_PERIOD_S, self._publish_pose)

    def destroy_node(self) -> None:
        """Destroy the node; its robot keeps its pose."""
        self.robot._finish()
        super().destroy_node()

    def _refuse(self, policy: int) -> None:
        self.robot.refused = qos_policy_name_from_kind(policy)
        self.get_logger().warning(f'A publisher was refused: {self.robot.refused}')

    def _publish_pose(self) -> None:
        robot, odometry = self.robot, Odometry()
        odometry.header.stamp = self.get_clock().now().to_msg()
        odometry.header.frame_id, odometry.child_frame_id = 'odom', 'base_link'
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = robot.x, robot.y
        odometry.pose.pose.orientation.z = math.sin(robot.heading / 2)
        odometry.pose.pose.orientation.w = math.cos(robot.heading / 2)
        self._odometry.publish(odometry)


def robot(source: str | TopicRecord = 'cmd_vel', *, qos: QoSProfile | int = 10) -> Robot:
    """
    Show a robot that obeys the commands on a topic; it replaces the robot of an earlier call.

    :param source: name of a topic with ``geometry_msgs/msg/Twist``; or a recorded topic of a
        simulation, as in ``robot(run['cmd_vel'])``
    :param qos: profile of its subscription, or a depth; with a deadline, silence stops the robot
    :returns: the robot, with ``x``, ``y``, ``heading``, ``moving``, ``at_wall`` and ``commands``
    :raises RoslabError: if the recorded topic does not have this type
    """
    if isinstance(source, TopicRecord):
        return _replayed(source)

    node = session().start(lambda: RobotNode(source, qos))
    assert isinstance(node, RobotNode)
    node.robot.begin()
    return node.robot


def _replayed(record: TopicRecord) -> Robot:
    """Return the robot at the end of a simulation."""
    if record.type != _TWIST:
        raise RoslabError(
            f'robot() expected commands of type {_TWIST}, but {record.topic} has {record.type}. '
            "Pass another topic of the simulation, as in robot(run['cmd_vel'])."
        )
    track = Track()
    for time_s, command in zip(record.times, record.messages):
        track.obey(time_s, command.linear.x, command.angular.z)
    track.advance(record.seconds)
    driven = Robot(track)
    driven.begin()
    return driven
