import random

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


def main(args=None):
    rclpy.init(args=args)
    node = Node('temperature_publisher')
    publisher = node.create_publisher(Temperature, 'temperature_topic', 10)
    while rclpy.ok():
        msg = Temperature()
        msg.temperature_value = random.uniform(20.0, 35.0)
        msg.unit = 'Celsius'
        msg.timestamp = node.get_clock().now().to_msg()
        msg.sensor_id = 'temp_sensor_01'
        publisher.publish(msg)
        node.get_logger().info('published')
        rclpy.spin_once(node, timeout_sec=1.0)  # waits for one second


if __name__ == '__main__':
    main()
