from threading import Timer

import rclpy
from temp_monitor_pkg.msg import Num, Temperature


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('milli_reader')
    publisher = node.create_publisher(Temperature, 'readings', 10)

    def convert(number):
        reading = Temperature()
        reading.temperature_value = number.num / 1000.0
        reading.unit = 'Celsius'
        reading.timestamp = node.get_clock().now().to_msg()
        reading.sensor_id = number.description
        Timer(0.2, publisher.publish, args=[reading]).start()

    node.create_subscription(Num, 'raw', convert, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
