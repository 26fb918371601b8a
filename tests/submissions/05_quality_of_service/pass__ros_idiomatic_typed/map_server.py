#!/usr/bin/env python3
"""Map server."""

from __future__ import annotations

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy, QoSProfile, QoSReliabilityPolicy
from rclpy.subscription import Subscription
from std_msgs.msg import String

MAP_QOS: QoSProfile = QoSProfile(
    history=QoSHistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)


class MapServer(Node):
    """Holds the latest map for late joiners."""

    def __init__(self) -> None:
        super().__init__('map_server')
        self._map_pub: Publisher = self.create_publisher(String, 'map', MAP_QOS)
        self._survey_sub: Subscription = self.create_subscription(
            String, 'survey', self._on_survey, qos_profile=10
        )
        self._publish('unknown')

    def _on_survey(self, msg: String) -> None:
        self.get_logger().info(f'New survey: "{msg.data}"')
        self._publish(msg.data)

    def _publish(self, text: str) -> None:
        self._map_pub.publish(String(data=text))


def main(args: list[str] | None = None) -> int:
    rclpy.init(args=args)
    node = MapServer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == '__main__':
    sys.exit(main())
