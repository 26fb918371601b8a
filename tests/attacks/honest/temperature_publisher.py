"""An honest temperature publisher, which attacks import and modify."""

import random

import rclpy
from rclpy.node import Node

from temp_monitor_pkg.msg import Temperature


class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.timer = self.create_timer(1.0, self.tick)

    def reading(self):
        message = Temperature(unit='Celsius', sensor_id='temp_sensor_01')
        message.temperature_value = 20.0 + random.random()
        message.timestamp = self.get_clock().now().to_msg()
        return message

    def tick(self):
        self.publisher.publish(self.reading())


def main():
    rclpy.init()
    rclpy.spin(TemperaturePublisher())
