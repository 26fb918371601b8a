from math import isnan
from statistics import fmean

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    def __init__(self):
        super().__init__('running_mean')
        self.seen = []
        self.sub = self.create_subscription(Float64, 'readings', self.on_reading, 10)
        self.pub = self.create_publisher(Float64, 'mean', 10)

    async def on_reading(self, message, info):
        if not isnan(message.data):
            self.seen.append(message.data)
            self.pub.publish(Float64(data=fmean(self.seen)))


def main(args=None):
    rclpy.init(args=args)
    node = RunningMean()
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        while rclpy.ok():
            executor.spin_once(timeout_sec=0.1)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
