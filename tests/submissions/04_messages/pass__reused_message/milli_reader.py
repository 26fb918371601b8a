"""Thousandths to degrees, one message object used again and again."""

from decimal import Decimal

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile

import temp_monitor_pkg.msg as types


class Reader(Node):
    """Converts in place."""

    def __init__(self):
        """Make one message for good: publish() turns it into bytes at once."""
        super().__init__('milli_reader')
        self.reading = types.Temperature(unit='Celsius')
        self.out = self.create_publisher(types.Temperature, 'readings', QoSProfile(depth=10))
        self.sub = self.create_subscription(types.Num, 'raw', self.on_raw, QoSProfile(depth=10))

    def on_raw(self, msg):
        """Fill it in and publish it."""
        self.reading.temperature_value = float(Decimal(msg.num) / 1000)
        self.reading.sensor_id = msg.description
        nanoseconds = self.get_clock().now().nanoseconds
        self.reading.timestamp.sec, self.reading.timestamp.nanosec = divmod(nanoseconds, 10**9)
        self.out.publish(self.reading)


def main(args=None):
    """Run it in an executor."""
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Reader())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
