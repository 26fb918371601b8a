#!/usr/bin/env python3
"""Pass commands on to a robot, not too fast, and stop it when no command comes."""

from geometry_msgs.msg import Twist
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

MAX_SPEED = 0.5
SILENCE_S = 0.5


class SafetyStop(Node):
    """A node between a driver and a robot."""

    def __init__(self):
        """Create the node, its endpoints, and a timer that ticks only in a silence."""
        super().__init__('safety_stop')
        # 1. self.commands publishes Twist on 'cmd_vel'.
        # 2. A subscription on 'cmd_vel_raw' calls self.guard.
        # 3. self.silence: a timer of SILENCE_S that calls self.stop, with autostart=False.
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Twist, 'cmd_vel_raw', self.guard, 10)
        self.silence = self.create_timer(SILENCE_S, self.stop, autostart=False)

    def guard(self, command):
        """Pass a command on, not too fast, and measure the silence from now on."""
        # 4. Limit command.linear.x on both sides, and publish the command.
        # 5. Reset the timer: its period begins again.
        command.linear.x = max(-MAX_SPEED, min(command.linear.x, MAX_SPEED))
        self.commands.publish(command)
        if command.linear.x or command.angular.z:
            self.silence.reset()
        else:
            self.silence.cancel()

    def stop(self):
        """Stop the robot, once."""
        # 6. Cancel the timer, and publish an empty Twist.
        self.silence.cancel()
        self.commands.publish(Twist())


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = SafetyStop()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
