import math
import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    def __init__(self):
        super().__init__('running_mean')
        self.new = []
        self.count, self.total = 0, 0.0
        self.out = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.new.append, 10)
        threading.Thread(target=self.answer, daemon=True).start()

    def answer(self):
        while True:
            time.sleep(0.1)
            while self.new:
                number = self.new.pop(0).data
                if math.isnan(number):
                    continue
                self.count += 1
                self.total += number
                self.out.publish(Float64(data=self.total / self.count))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(RunningMean())


if __name__ == '__main__':
    main()
