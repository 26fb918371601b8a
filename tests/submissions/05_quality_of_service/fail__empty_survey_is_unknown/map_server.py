#!/usr/bin/env python3
"""A map server built from a small memory class and a node around it."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

NOTHING_YET = 'unknown'


class Atlas:
    """Remember the text of the newest map."""

    def __init__(self):
        self.text = NOTHING_YET

    def update(self, text):
        self.text = text or NOTHING_YET
        return self.text


class MapServer(Node):

    def __init__(self):
        super().__init__('map_server')
        self.atlas = Atlas()
        qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE,
                         durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'map', qos)
        self.create_subscription(String, 'survey', self.take, 10)
        self.publish(self.atlas.text)

    def publish(self, text):
        self.publisher.publish(String(data=text))

    def take(self, survey):
        self.publish(self.atlas.update(survey.data))


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
