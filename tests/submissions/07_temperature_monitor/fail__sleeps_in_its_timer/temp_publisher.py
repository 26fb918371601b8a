import math
import time

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.timer = self.create_timer(1.0, self.publish_reading)

    def publish_reading(self):
        msg = Temperature()
        msg.temperature_value = 22.0 + 3.0 * math.sin(time.time())
        msg.unit = 'Celsius'
        msg.timestamp = self.get_clock().now().to_msg()
        msg.sensor_id = 'temp_sensor_01'
        time.sleep(2.5)
        self.publisher.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(TemperaturePublisher())


if __name__ == '__main__':
    main()
