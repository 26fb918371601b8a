"""Thousandths to degrees, with functions only."""

import rclpy
from rclpy.executors import ExternalShutdownException

from temp_monitor_pkg.msg import Num, Temperature


def converted(number, now):
    """Return the reading for a number."""
    return Temperature(
        temperature_value=float(number.num) / 1000,
        unit='Celsius',
        timestamp=now,
        sensor_id=number.description,
    )


def main(args=None):
    """Wire a node and spin it."""
    rclpy.init(args=args)
    node = rclpy.create_node('milli_reader')
    out = node.create_publisher(Temperature, 'readings', 10)

    def on_number(number):
        out.publish(converted(number, node.get_clock().now().to_msg()))

    node.create_subscription(Num, 'raw', on_number, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
