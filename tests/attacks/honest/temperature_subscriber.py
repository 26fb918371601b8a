"""An honest temperature subscriber, which attacks import and modify."""

import rclpy
from rclpy.node import Node

from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.subscription = self.create_subscription(
            Temperature, 'temperature_topic', self.heard, 10
        )

    def heard(self, message):
        celsius = message.temperature_value
        if message.unit == 'Fahrenheit':
            celsius = (celsius - 32.0) / 1.8
        elif message.unit != 'Celsius':
            self.get_logger().error(f'unknown unit {message.unit!r}')
            return
        self.get_logger().info(f'{celsius:.2f} degrees')
        if celsius > 30.0:
            self.get_logger().warning('too hot')


def main():
    rclpy.init()
    rclpy.spin(TemperatureSubscriber())
