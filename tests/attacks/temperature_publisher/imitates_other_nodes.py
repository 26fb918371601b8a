"""
Tries: confuse the observer with nodes of the same name and with services it may ask.

Deserves: 15 at most
Flag: same name
"""


import random

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.create_timer(1.0, self.tick)

    def tick(self):
        message = Temperature(unit='Celsius', sensor_id='temp_sensor_01')
        message.temperature_value = 20.0 + random.random()
        message.timestamp = self.get_clock().now().to_msg()
        self.publisher.publish(message)


def main():
    rclpy.init()
    rclpy.spin(TemperaturePublisher())


if __name__ == '__main__':
    rclpy.init()
    twins = [rclpy.create_node('temperature_publisher') for _ in range(3)]
    rclpy.init = lambda *args, **options: None
    main()
