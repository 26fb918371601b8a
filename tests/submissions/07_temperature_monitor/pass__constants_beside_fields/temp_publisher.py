import math

import rclpy
from temp_monitor_pkg.msg import Temperature


class Sensor:
    """Has a node, and is none."""

    def __init__(self):
        self.node = rclpy.create_node('temperature_publisher')
        self.publish = self.node.create_publisher(Temperature, 'temperature_topic', 10).publish
        self.angle = 0.0

    def start(self):
        self.node.create_timer(1.0, self.step)
        return self

    def step(self):
        self.angle += math.radians(6.0)
        self.publish(self.reading(25.0 + 10.0 * math.sin(self.angle)))

    def reading(self, celsius):
        reading = Temperature(unit='Celsius', sensor_id='temp_sensor_01')
        reading.timestamp = self.node.get_clock().now().to_msg()
        reading.temperature_value = celsius
        return reading


def main():
    rclpy.init()
    sensor = Sensor().start()
    rclpy.spin(sensor.node)


if __name__ == '__main__':
    main()
