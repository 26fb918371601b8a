import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

class TemperatureSubscriber(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.last = None
        self.create_subscription(Temperature, 'temperature_topic', self.keep, 10)
        self.create_timer(1.0, self.show)
    def keep(self, msg):
        self.last = msg
    def show(self):
        msg = self.last
        if msg is None: return
        v = msg.temperature_value
        self.get_logger().info(f'{v} {msg.unit}')
        if msg.unit == 'Fahrenheit':
            v = (v - 32) / 1.8
        elif msg.unit != 'Celsius':
            self.get_logger().error('unknown unit ' + msg.unit)
            return
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
