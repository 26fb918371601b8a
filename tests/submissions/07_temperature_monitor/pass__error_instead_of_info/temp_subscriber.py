import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

class TemperatureSubscriber(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.create_subscription(Temperature, 'temperature_topic', self.judge, 10)

    def judge(self, msg):
        v = msg.temperature_value
        if msg.unit == 'Fahrenheit':
            v = (v - 32) / 1.8
        elif msg.unit != 'Celsius':
            self.get_logger().error('unknown unit ' + msg.unit)
            return
        self.get_logger().info(f'{msg.temperature_value} {msg.unit}')
        if v > 30:
            self.get_logger().warn(f'hot {v}')


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
