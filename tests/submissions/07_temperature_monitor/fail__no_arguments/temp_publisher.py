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
    rclpy.init(args=[])
    node = P()
    node.create_timer(1.0, node.tick)
    rclpy.spin(node)

if __name__ == '__main__':
    main()
