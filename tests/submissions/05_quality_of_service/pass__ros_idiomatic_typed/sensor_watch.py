#!/usr/bin/env python3
"""Sensor watch."""

from __future__ import annotations

import sys
from typing import Final

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import (
    QoSRequestedDeadlineMissedInfo,
    QoSRequestedIncompatibleQoSInfo,
    SubscriptionEventCallbacks,
)
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind, QoSProfile, QoSReliabilityPolicy
from std_msgs.msg import Float64

PERIOD_S: Final[float] = 0.3


class SensorWatch(Node):
    """Logs distances; complains about silence."""

    def __init__(self) -> None:
        super().__init__('sensor_watch')
        self._sub = self.create_subscription(
            msg_type=Float64,
            topic='distance',
            callback=self._on_distance,
            qos_profile=QoSProfile(
                depth=5,
                reliability=QoSReliabilityPolicy.BEST_EFFORT,
                deadline=Duration(seconds=PERIOD_S),
            ),
            event_callbacks=SubscriptionEventCallbacks(
                deadline=self._on_deadline_missed,
                incompatible_qos=self._on_incompatible_qos,
            ),
        )

    def _on_distance(self, msg: Float64) -> None:
        self.get_logger().info(f'distance: {msg.data:.2f} m')

    def _on_deadline_missed(self, info: QoSRequestedDeadlineMissedInfo) -> None:
        self.get_logger().warning(f'deadline missed {info.total_count_change} time(s)')

    def _on_incompatible_qos(self, info: QoSRequestedIncompatibleQoSInfo) -> None:
        name = qos_policy_name_from_kind(info.last_policy_kind)
        self.get_logger().error(f'incompatible publisher, policy {name}')


def main(args: list[str] | None = None) -> int:
    rclpy.init(args=args)
    node = SensorWatch()
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
