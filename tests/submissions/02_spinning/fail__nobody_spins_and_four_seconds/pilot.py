#!/usr/bin/env python3
"""Steer a robot with the latest speed and the latest turn."""

from geometry_msgs.msg import Twist
import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

PERIOD_S = 0.5
OLD = Duration(seconds=4.0)


class Pilot(Node):
    """A node that keeps the latest of two topics, and publishes both together."""

    def __init__(self):
        """Create the node, its publisher, its two subscriptions and its timer."""
        super().__init__('pilot')
        self.speed = self.turn = None
        self.speed_time = self.turn_time = None
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Float64, 'speed', self.keep_speed, 10)
        self.create_subscription(Float64, 'turn', self.keep_turn, 10)
        self.create_timer(PERIOD_S, self.steer)

    def keep_speed(self, message):
        """Keep a speed, and when it came."""
        self.speed, self.speed_time = message.data, self.get_clock().now()

    def keep_turn(self, message):
        """Keep a turn, and when it came."""
        self.turn, self.turn_time = message.data, self.get_clock().now()

    def steer(self):
        """Publish the latest of both, or zeros if one is old; nothing if one has not come yet."""
        if self.speed is None or self.turn is None:
            return
        command = Twist()
        if self.get_clock().now() - min(self.speed_time, self.turn_time) <= OLD:
            command.linear.x = self.speed
            command.angular.z = self.turn
        self.commands.publish(command)


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = Pilot()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
