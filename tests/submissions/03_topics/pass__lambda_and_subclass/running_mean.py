import math

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    def __init__(self):
        super().__init__('running_mean')
        self.n, self.mean = 0, Float64()
        out = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(
            Float64, 'readings', lambda m: math.isnan(m.data) or out.publish(self.update(m.data)), 10
        )

    def update(self, value):
        self.n += 1
        self.mean.data += (value - self.mean.data) / self.n
        return self.mean


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(RunningMean())
