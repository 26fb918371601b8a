import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperatureSubscriber(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.complained_about = []
        self.create_subscription(Temperature, 'temperature_topic', self.heard, 10)

    def heard(self, msg):
        if msg.unit == 'Celsius':
            degrees = msg.temperature_value
        elif msg.unit == 'Fahrenheit':
            degrees = (msg.temperature_value - 32) / 1.8
        else:
            if msg.unit not in self.complained_about:
                self.get_logger().error('I do not know the unit ' + repr(msg.unit))
                self.complained_about.append(msg.unit)
            return
        self.get_logger().info(f'{msg.temperature_value} {msg.unit}')
        if degrees > 30.0:
            self.get_logger().warning(f'hot: {degrees}')


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
