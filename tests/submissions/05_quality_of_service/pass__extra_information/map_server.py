#!/usr/bin/env python3
"""Serve the newest map, count them, and offer more than is asked for."""

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Int32, String


class MapServer(Node):
    """A node that remembers one map and counts all of them."""

    def __init__(self):
        """Create the node and its endpoints, and publish the first map."""
        super().__init__('map_server')
        latched = QoSProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
            liveliness=LivelinessPolicy.AUTOMATIC,
            liveliness_lease_duration=Duration(seconds=2),
        )
        events = PublisherEventCallbacks(matched=self.somebody)
        self.publisher = self.create_publisher(String, 'map', latched, event_callbacks=events)
        self.counter = self.create_publisher(Int32, 'map_count', 10)
        self.count = 0
        self.create_subscription(String, 'survey', self.take, 10)
        self.publish('unknown')

    def publish(self, text):
        """Publish a map and the number of maps."""
        self.count += 1
        self.publisher.publish(String(data=text))
        self.counter.publish(Int32(data=self.count))

    def take(self, survey):
        """Publish a survey as the new map."""
        self.get_logger().info(f'Map {self.count}: {survey.data}')
        self.publish(survey.data)

    def somebody(self, event):
        """Log how many listen."""
        self.get_logger().info(f'{event.current_count} listeners')


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = MapServer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
