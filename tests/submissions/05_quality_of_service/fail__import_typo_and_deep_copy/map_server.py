#!/usr/bin/env python3
"""Serve the newest map to whoever is there, and to whoever comes later."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QosProfile, ReliabilityPolicy
from std_msgs.msg import String


class MapServer(Node):
    """A node that remembers one map."""

    def __init__(self):
        """Create the node and its endpoints, and publish the first map."""
        super().__init__('map_server')
        # 1. a QosProfile: which reliability, which durability, how many maps to keep?
        # 2. self.publisher: String on 'map', with that profile
        # 3. a subscription: String on 'survey', self.take, depth 10
        # 4. publish the first map

        latched = QosProfile(
            depth=1,
            reliability=ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL,
        )
        self.publisher = self.create_publisher(String, 'map', latched)
        self.create_subscription(String, 'survey', self.take, 10)
        self.publisher.publish(String(data='unknown'))


    def take(self, survey):
        """
        Publish a survey as the new map.

        :param survey: the String that has arrived
        """
        # 5. One line.

        self.publisher.publish(String(data=survey.data))



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
