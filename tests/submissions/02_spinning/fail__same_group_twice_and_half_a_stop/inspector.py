#!/usr/bin/env python3
"""Inspect pictures, which takes long, and still send a heartbeat."""

import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty, String

BEAT_S = 0.5


def inspect(picture):
    """Return what is in a picture. It takes 1.2 s; leave this function as it is."""
    time.sleep(1.2)
    return picture.upper()


class Inspector(Node):
    """A node with a slow callback, and a timer that must not wait for it."""

    def __init__(self):
        """Create the node, its publishers, its timer and its subscription."""
        super().__init__('inspector')
        self.alive = self.create_publisher(Empty, 'alive', 10)
        self.results = self.create_publisher(String, 'results', 10)
        beating = looking = MutuallyExclusiveCallbackGroup()
        self.create_timer(BEAT_S, self.beat, callback_group=beating)
        self.create_subscription(String, 'pictures', self.look, 10, callback_group=looking)

    def beat(self):
        """Send one heartbeat."""
        self.alive.publish(Empty())

    def look(self, message):
        """Inspect one picture and publish the result."""
        self.results.publish(String(data=inspect(message.data)))


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = Inspector()
    try:
        executor = MultiThreadedExecutor(num_threads=2)
        executor.add_node(node)
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
