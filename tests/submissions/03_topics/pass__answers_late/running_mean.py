import math
import queue
import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):

    def __init__(self):
        super().__init__('running_mean')
        self.numbers = queue.Queue()
        self.publisher = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.take, 10)
        threading.Thread(target=self.work, daemon=True).start()

    def take(self, message):
        self.numbers.put(message.data)

    def work(self):
        count, total = 0, 0.0
        while True:
            number = self.numbers.get()
            time.sleep(2.0)
            if math.isnan(number):
                continue
            count += 1
            total += number
            self.publisher.publish(Float64(data=total / count))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(RunningMean())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
