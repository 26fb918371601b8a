#!/usr/bin/env python3
from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Final

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.timer import Timer
from temp_monitor_pkg.msg import Temperature as Reading

QOS: Final = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)


@dataclass(frozen=True)
class Settings:
    """What may be chosen."""

    period_s: float = 1.0
    mean_c: float = 25.0
    swing_c: float = 8.0


class TemperaturePublisher(Node):
    """A sensor in the sun: warm at noon, cool at night."""

    def __init__(self, settings: Settings) -> None:
        super().__init__('temperature_publisher')
        self._settings: Settings = settings
        self._publisher: Publisher = self.create_publisher(Reading, 'temperature_topic', QOS)
        self._timer: Timer = self.create_timer(settings.period_s, self._on_timer)

    def _temperature(self, now_s: float) -> float:
        swing = self._settings.swing_c * math.sin(2.0 * math.pi * now_s / 60.0)
        return self._settings.mean_c + swing

    def _on_timer(self) -> None:
        now = self.get_clock().now()
        reading = Reading()
        reading.temperature_value = self._temperature(now.nanoseconds / 1e9)
        reading.unit = 'Celsius'
        reading.timestamp = now.to_msg()
        reading.sensor_id = 'temp_sensor_01'
        self._publisher.publish(reading)
        self.get_logger().debug(f'{reading}')


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    node = TemperaturePublisher(Settings())
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
