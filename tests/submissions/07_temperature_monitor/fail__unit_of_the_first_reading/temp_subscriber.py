#!/usr/bin/env python3
"""Watch thermometers; each of them has its unit."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

KNOWN = ('Celsius', 'Fahrenheit')


class TemperatureSubscriber(Node):

    def __init__(self):
        super().__init__('temperature_subscriber')
        self.units = {}  # of each sensor
        self.create_subscription(Temperature, 'temperature_topic', self.judge_reading, 10)

    def judge_reading(self, message):
        log = self.get_logger()
        if message.unit not in KNOWN:
            log.error(f'{message.sensor_id} sends the unit {message.unit!r}')
            return
        log.info(f'{message.sensor_id}: {message.temperature_value:.2f} {message.unit}')
        unit = self.units.setdefault(message.sensor_id, message.unit)
        celsius = message.temperature_value
        if unit == 'Fahrenheit':
            celsius = (celsius - 32.0) * 5.0 / 9.0
        if celsius > 30.0:
            log.warning(f'{message.sensor_id} is too warm')


def main(args=None):
    """Run the node until it is interrupted or terminated."""
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
