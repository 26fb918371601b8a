from collections import deque

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from temp_monitor_pkg.msg import Num, Temperature


class MilliReader(Node):
    def __init__(self):
        super().__init__('milli_reader')
        self.waiting = deque()
        self.pub = self.create_publisher(Temperature, 'readings', 10)
        self.sub = self.create_subscription(Num, 'raw', self.remember, 10)
        self.timer = self.create_timer(0.01, self.work)

    def remember(self, number):
        self.waiting.append(number)

    def work(self):
        while self.waiting:
            number = self.waiting.popleft()
            msg = Temperature()
            msg.temperature_value = number.num / 1000
            msg.unit = 'Celsius'
            seconds, nanoseconds = self.get_clock().now().seconds_nanoseconds()
            msg.timestamp.sec = seconds
            msg.timestamp.nanosec = nanoseconds
            msg.sensor_id = number.description
            self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = MilliReader()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
