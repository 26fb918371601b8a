import math

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.create_subscription(Temperature, 'temperature_topic', self.on_reading, 10)

    def on_reading(self, msg):
        value = msg.temperature_value
        if math.isnan(value):
            self.get_logger().warning('invalid reading, is the sensor broken?')
            return
        if msg.unit not in ('Celsius', 'Fahrenheit'):
            self.get_logger().error('unknown unit')
            return
        celsius = (value - 32) / 1.8 if msg.unit == 'Fahrenheit' else value
        self.get_logger().info(f'{celsius:.2f}')
        if celsius > 30.0:
            self.get_logger().warning(f'{celsius:.2f} is too hot')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TemperatureSubscriber())


if __name__ == '__main__':
    main()
