"""
Tries: put markup, terminal codes and spreadsheet formulas where people will read them.

Deserves: 14
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
    import sys
    HOSTILE = "=HYPERLINK(1)<script>alert('X')</script>\x1b[2J"
    sys.stderr.write(HOSTILE)
    fill = TemperaturePublisher.tick

    def tick(self):
        message = Temperature(unit='Celsius', sensor_id=HOSTILE)
        message.temperature_value = 20.0 + random.random()
        message.timestamp = self.get_clock().now().to_msg()
        self.publisher.publish(message)

    TemperaturePublisher.tick = tick
    main()
