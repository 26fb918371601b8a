#!/usr/bin/env python3
"""Turn the numbers of an old device into readings of a thermometer."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):
    """A node that hears Num and publishes Temperature."""

    def __init__(self):
        """Create the node, its publisher and its subscription."""
        super().__init__('milli_reader')
        # 1. A publisher of Temperature on readings, a subscription to Num on raw.
        self.publisher = self.create_publisher(Temperature, 'readings', 10)
        self.last = None
        self.create_timer(0.1, self.tell)
        self.create_subscription(Num, 'raw', self.convert, 10)

    def convert(self, number):
        """
        Publish one reading for one number.

        :param number: the Num that has arrived, in thousandths of a degree
        """
        # 2. Make a new Temperature, fill in its four fields, and publish it.
        self.last = number

    def tell(self):
        number, self.last = self.last, None
        if number is None:
            return
        reading = Temperature()
        reading.temperature_value = number.num / 1000.0
        reading.unit = 'Celsius'
        reading.timestamp = self.get_clock().now().to_msg()
        reading.sensor_id = number.description
        self.publisher.publish(reading)


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = None
    try:
        node = MilliReader()
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
