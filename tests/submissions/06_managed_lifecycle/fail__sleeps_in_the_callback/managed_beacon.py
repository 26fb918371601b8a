#!/usr/bin/env python3
"""A beacon that a supervisor configures, switches on and off, and cleans up."""

import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String

PERIOD_S = 1.0


class Beacon(LifecycleNode):
    """A beacon that flashes once a second while it is active."""

    def __init__(self):
        """Create the node, and nothing else yet."""

        super().__init__('beacon')


    def on_configure(self, state):
        """
        Create what the beacon needs.

        :param state: where we come from
        :returns: how it went
        """

        self.publisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.timer = self.create_timer(PERIOD_S, self.flash)
        return super().on_configure(state)


    def on_cleanup(self, state):
        """
        Take away what on_configure() has created.

        :param state: where we come from
        :returns: how it went
        """

        self.destroy_timer(self.timer)
        self.destroy_lifecycle_publisher(self.publisher)
        return super().on_cleanup(state)


    def flash(self):
        """Publish one flash; the publisher drops it unless the node is active."""
        self.publisher.publish(String(data='flash'))
        time.sleep(2.0)


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = Beacon()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
