import math

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.timer = self.create_timer(1.0, self.publish_reading)

    def publish_reading(self):
        timestamp = self.get_clock().now().to_msg()
        value = 22.0 + 3.0 * math.sin(timestamp.sec)
        msg = Temperature(temperature_value=value, unit='Celsius', sensor_id='temp_sensor_01')
        self.publisher.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TemperaturePublisher())


if __name__ == '__main__':
    main()
