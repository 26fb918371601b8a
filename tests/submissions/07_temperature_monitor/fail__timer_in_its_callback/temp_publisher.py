import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.elapsed = 0.0
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.timer = self.create_timer(1.0, self.publish_reading)

    def publish_reading(self):
        self.elapsed += 1.0
        message = Temperature()
        message.temperature_value = 20.0 + self.elapsed * 0.1
        message.unit = 'Celsius'
        message.timestamp = self.get_clock().now().to_msg()
        message.sensor_id = 'temp_sensor_01'
        self.publisher.publish(message)
        self.get_logger().info(f'{message.temperature_value:.2f}')
        self.timer = self.create_timer(1.0, self.publish_reading)


def main(args=None):
    rclpy.init(args=args)
    node = TemperaturePublisher()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
