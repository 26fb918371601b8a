"""Thousandths to whole degrees, with the computer's clock."""

import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):
    """A node that hears Num and publishes Temperature."""

    def __init__(self):
        """Create the node, its publisher and its subscription."""
        super().__init__('milli_reader')
        self.publisher = self.create_publisher(Temperature, 'readings', 10)
        self.create_subscription(Num, 'raw', self.convert, 10)

    def convert(self, number):
        """Publish one reading for one number."""
        reading = Temperature()
        reading.temperature_value = float(number.num // 1000)
        reading.unit = 'Celsius'
        now = time.time()
        reading.timestamp.sec = int(now)
        reading.timestamp.nanosec = int(now % 1 * 1e9)
        reading.sensor_id = number.description
        self.publisher.publish(reading)


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = MilliReader()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
