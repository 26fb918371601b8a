from contextlib import suppress

import rclpy
from rclpy.executors import ExternalShutdownException
from temp_monitor_pkg.msg import Num, Temperature


def make_milli_reader(divisor=1000.0, unit='Celsius'):
    node = rclpy.create_node('milli_reader')
    pub = node.create_publisher(Temperature, 'readings', 10)
    node.create_subscription(
        Num,
        'raw',
        lambda n: pub.publish(
            Temperature(
                sensor_id=n.description,
                unit=unit,
                temperature_value=n.num / divisor,
                timestamp=node.get_clock().now().to_msg(),
            )
        ),
        10,
    )
    return node


def main(args=None):
    rclpy.init(args=args)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(make_milli_reader())
