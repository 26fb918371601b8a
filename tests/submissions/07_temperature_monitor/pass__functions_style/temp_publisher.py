import itertools
import math

import rclpy
from rclpy.executors import ExternalShutdownException
from temp_monitor_pkg.msg import Temperature


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('temperature_publisher')
    pub = node.create_publisher(Temperature, 'temperature_topic', 10)
    count = itertools.count()

    def tick():
        value = 25.0 + 8.0 * math.sin(next(count) / 10)
        pub.publish(
            Temperature(
                temperature_value=value,
                unit='Celsius',
                timestamp=node.get_clock().now().to_msg(),
                sensor_id='temp_sensor_01',
            )
        )

    node.create_timer(1.0, tick)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
