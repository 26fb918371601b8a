#!/usr/bin/env python3
"""Karten-Server: merkt sich die Karte fuer alle, die spaeter kommen."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

KARTEN_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_ALL,
    depth=1,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)


class KartenServer(Node):

    def __init__(self):
        super().__init__('map_server')
        self.publisher = self.create_publisher(String, 'map', KARTEN_QOS)
        self.create_subscription(String, 'survey', self.take, 10)
        self.publisher.publish(String(data='unknown'))

    def take(self, survey):
        self.publisher.publish(survey)


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = KartenServer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
