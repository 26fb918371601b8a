import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):
    """Logs each reading once; a start, a conversion and a record have lines of their own."""

    def __init__(self):
        super().__init__('temperature_subscriber')
        self.highest = float('-inf')
        self.count = 0
        self.create_subscription(Temperature, 'temperature_topic', self.on_reading, 10)
        self.get_logger().info('monitor is up, limit 30.0 degC')

    def on_reading(self, msg):
        value = msg.temperature_value
        self.count += 1
        self.get_logger().info(f'{value:.2f} {msg.unit} ({msg.sensor_id})')
        if msg.unit == 'Fahrenheit':
            celsius = (value - 32) * 5 / 9
            self.get_logger().info(f'{value:.2f} degF are {celsius:.2f} degC')
        elif msg.unit == 'Celsius':
            celsius = value
        else:
            self.get_logger().error(f'unit {msg.unit!r} is unknown')
            return
        if celsius > self.highest:
            self.highest = celsius
            self.get_logger().info(f'highest so far: {celsius:.2f} degC')
        if self.count % 5 == 0:
            self.get_logger().info(f'{self.count} readings so far')
        if celsius > 30.0:
            self.get_logger().warning(f'too hot: {celsius:.2f} degC')


def main(args=None):
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
