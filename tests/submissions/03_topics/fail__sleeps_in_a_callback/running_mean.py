import math
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):

    def __init__(self):
        super().__init__('running_mean')
        self.numbers = []
        self.publisher = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.take, 10)

    def take(self, message):
        if math.isnan(message.data):
            return
        self.numbers.append(message.data)
        self.tell()
        threading.Timer(1.0, self.tell).start()

    def tell(self):
        self.publisher.publish(Float64(data=sum(self.numbers) / len(self.numbers)))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(RunningMean())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
