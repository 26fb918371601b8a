import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.create_subscription(Temperature, 'temperature_topic', self.on_reading, 10)

    def on_reading(self, msg):
        if msg.unit == 'Celsius':
            celsius = msg.temperature_value
        elif msg.unit == 'Farenheit':
            celsius = (msg.temperature_value - 32) / 1.8
        else:
            self.get_logger().error(f'I do not know the unit {msg.unit}')
            return
        self.get_logger().info(f'Temperature: {celsius:.2f}')
        if celsius > 30.0:
            self.get_logger().warning('Too hot!')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TemperatureSubscriber())


if __name__ == '__main__':
    main()
