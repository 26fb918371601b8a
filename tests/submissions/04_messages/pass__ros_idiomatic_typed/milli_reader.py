#!/usr/bin/env python3
"""Convert raw counts to temperatures."""

from __future__ import annotations

import sys

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.subscription import Subscription
from temp_monitor_pkg.msg import Num, Temperature

MILLI: float = 1e-3


class MilliReader(Node):
    """Republishes Num as Temperature."""

    def __init__(self) -> None:
        super().__init__('milli_reader')
        self._pub: Publisher = self.create_publisher(
            msg_type=Temperature, topic='readings', qos_profile=10
        )
        self._sub: Subscription = self.create_subscription(
            msg_type=Num, topic='raw', callback=self._on_raw, qos_profile=10
        )

    def _on_raw(self, msg: Num) -> None:
        self._pub.publish(self._to_temperature(msg))
        self.get_logger().debug(f'converted {msg.num}')

    def _to_temperature(self, msg: Num) -> Temperature:
        return Temperature(
            temperature_value=msg.num * MILLI,
            unit='Celsius',
            timestamp=self.get_clock().now().to_msg(),
            sensor_id=msg.description,
        )


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    try:
        rclpy.spin(MilliReader())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    sys.exit(main())
