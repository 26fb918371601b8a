import random
import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class Oven(Node):
    """Heats in one callback, publishes in another."""

    def __init__(self):
        super().__init__('temperature_publisher')
        self.lock = threading.Lock()
        self.temperature = 20.0
        group = ReentrantCallbackGroup()
        self.pub = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.create_timer(0.5, self.heat, callback_group=group)
        self.create_timer(1.0, self.report, callback_group=group)

    def heat(self):
        with self.lock:
            self.temperature = min(80.0, self.temperature + random.uniform(0.1, 0.5))

    def report(self):
        message = Temperature()
        with self.lock:
            message.temperature_value = self.temperature
        message.unit, message.sensor_id = 'Celsius', 'temp_sensor_01'
        message.timestamp = self.get_clock().now().to_msg()
        self.pub.publish(message)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Oven())
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    try:
        thread.join()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
