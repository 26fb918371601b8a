"""Thousandths to degrees, in a loop around spin_once."""

import rclpy
from rclpy.executors import ExternalShutdownException

from temp_monitor_pkg.msg import Num, Temperature


def main(args=None):
    """Spin by hand and work through what has arrived."""
    rclpy.init(args=args)
    node = rclpy.create_node('milli_reader')
    publisher = node.create_publisher(Temperature, 'readings', 10)
    waiting = []
    node.create_subscription(Num, 'raw', lambda number: waiting.append(number), 10)
    try:
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=0.05)
            while waiting:
                number = waiting.pop(0)
                stamp = node.get_clock().now().to_msg()
                publisher.publish(
                    Temperature(
                        temperature_value=number.num * 0.001,
                        unit='Celsius',
                        timestamp=stamp,
                        sensor_id=number.description,
                    )
                )
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
