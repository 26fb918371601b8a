import random

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature

PERIOD_S = 0.1


class TemperaturePublisher(Node):
    def __init__(self):
        super().__init__('temperature_publisher')
        self.publisher = self.create_publisher(Temperature, 'temperature_topic', 10)
        self.ticks = 0
        self.timer = self.create_timer(PERIOD_S, self.tick)

    def tick(self):
        # Every tenth time.
        self.ticks += 1
        if self.ticks % 9 == 0:
            self.publish_reading()

    def publish_reading(self):
        msg = Temperature()
        msg.temperature_value = random.uniform(18.0, 26.0)
        msg.unit = 'Celsius'
        msg.sensor_id = 'temp_sensor_01'
        msg.timestamp = self.get_clock().now().to_msg()
        self.publisher.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = TemperaturePublisher()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
