#!/usr/bin/env python3
"""A beacon that a supervisor configures, switches on and off, and cleans up."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String

PERIOD_S = 1.0


class Beacon(LifecycleNode):
    """A beacon that flashes once a second while it is active."""

    def __init__(self):
        """Create the node, and nothing else yet."""
        # 1. Hand the node name to the parent class.

        super().__init__('beacon')


    def on_configure(self, state):
        """
        Create what the beacon needs.

        :param state: where we come from
        :returns: how it went
        """
        # 2. self.publisher: create_lifecycle_publisher(type, topic, depth)
        # 3. self.timer: create_timer(period in seconds, the method to call)
        # 4. Return what the parent class returns.

        self.publisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.timer = self.create_timer(PERIOD_S, self.flash)
        self.timer = self.create_timer(PERIOD_S, self.flash)
        return super().on_configure(state)


    def on_cleanup(self, state):
        """
        Take away what on_configure() has created.

        :param state: where we come from
        :returns: how it went
        """
        # 5. self.destroy_timer(...) and self.destroy_lifecycle_publisher(...)
        # 6. Return what the parent class returns.

        self.destroy_timer(self.timer)
        self.destroy_lifecycle_publisher(self.publisher)
        return super().on_cleanup(state)


    def flash(self):
        """Publish one flash; the publisher drops it unless the node is active."""
        self.publisher.publish(String(data='flash'))


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
