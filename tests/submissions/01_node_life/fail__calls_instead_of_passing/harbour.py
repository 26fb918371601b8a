#!/usr/bin/env python3
"""Two nodes in one process: a lookout and a keeper."""

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    """A node of the harbour that reports regularly."""

    def __init__(self, name, period_s):
        """
        Create the node and its timer.

        :param name: name of the node
        :param period_s: time between two reports [s]
        """
        # 1. Name and namespace go to the parent class.
        # 2. A timer calls self.report once a period.
        super().__init__(name, namespace='harbour')
        self.create_timer(period_s, self.report())

    def report(self):
        """Log one line at level INFO."""
        # 3. Speak with the node's own logger.
        self.get_logger().info('All quiet.')


def main(args=None):
    """Serve both nodes until the program is interrupted or terminated."""
    # 4. init; two Watchers; an executor that gets both with add_node; executor.spin().
    # 5. Whatever happens: destroy both, then rclpy.try_shutdown().
    rclpy.init(args=args)
    watchers = [Watcher('lookout', 1.0), Watcher('keeper', 2.0)]
    executor = SingleThreadedExecutor()
    for watcher in watchers:
        executor.add_node(watcher)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        for watcher in watchers:
            watcher.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
