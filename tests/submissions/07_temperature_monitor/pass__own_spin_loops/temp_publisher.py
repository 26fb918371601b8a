import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature
import random

class P(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.pub = self.create_publisher(Temperature, 'temperature_topic', 10)
    def tick(self):
        msg = Temperature(temperature_value=20.0 + random.random(), unit='Celsius', sensor_id='temp_sensor_01')
        msg.timestamp = self.get_clock().now().to_msg()
        self.pub.publish(msg)

def main():
    rclpy.init()
    node = P()
    last = node.get_clock().now().nanoseconds
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.01)
        if node.get_clock().now().nanoseconds - last >= 10**9:
            last += 10**9
            node.tick()

if __name__ == '__main__':
    main()
