#!/usr/bin/env python3
"""Count the watches of a night, and say so."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class NightWatch(Node):
    """A node that reports once a second, and louder every fifth time."""

    def __init__(self):
        """Create the node and its timer."""
        # 1. Name, counter, timer. The namespace is none of your business.
        super().__init__('night_watch')
        self.number = 0
        self.create_timer(1.0, self.report)

    def report(self):
        """Log the number of this watch."""
        # 2. Count; then INFO, or WARN if the number can be divided by five.
        # 3. One place in the code has one level: two lines, not one.
        number = 0
        number += 1
        self.number = number
        if self.number % 5 == 0:
            self.get_logger().warning(f'Watch {self.number}: who is relieving me?')
        else:
            self.get_logger().info(f'Watch {self.number}: all quiet.')


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    # 4. The same pattern as before, with rclpy.spin for a single node.
    rclpy.init(args=args)
    node = NightWatch()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
