#!/usr/bin/env python3
from __future__ import annotations

import math
from typing import Final

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature as Reading

THRESHOLD_C: Final[float] = 30.0


class TemperatureSubscriber(Node):
    """Logs, and warns."""

    def __init__(self) -> None:
        super().__init__('temperature_subscriber')
        self._subscription = self.create_subscription(
            msg_type=Reading, topic='temperature_topic', callback=self._on_reading, qos_profile=10
        )

    @staticmethod
    def _celsius(reading: Reading) -> float | None:
        match reading.unit:
            case 'Celsius':
                return reading.temperature_value
            case 'Fahrenheit':
                return (reading.temperature_value - 32.0) / 1.8
            case _:
                return None

    def _on_reading(self, reading: Reading) -> None:
        self.get_logger().info(f'{reading.sensor_id}: {reading.temperature_value} {reading.unit}')
        celsius = self._celsius(reading)
        if celsius is None:
            self.get_logger().error(f'unit {reading.unit!r} is not known')
        elif math.isnan(celsius):
            self.get_logger().error('the sensor sends NaN')
        elif celsius > THRESHOLD_C:
            self.get_logger().warning(f'{celsius:.3f} °C')


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    node = TemperatureSubscriber()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
