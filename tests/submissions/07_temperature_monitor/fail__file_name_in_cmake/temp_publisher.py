import random

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Float64, 'temperature_topic', 10)
        self.timer = self.create_timer(1.0, self.publish_reading)

    def publish_reading(self):
        message = Float64()
        message.data = random.uniform(20.0, 35.0)
        self.publisher.publish(message)


def main(args=None):
    rclpy.init(args=args)
    node = TemperaturePublisher()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
