from collections import deque
from statistics import mean
import math

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean:
    """Collects in the callback, answers in the loop of main()."""

    def __init__(self, context):
        self.node = Node('running_mean', context=context)
        self.inbox, self.numbers = deque(), []
        self.publisher = self.node.create_publisher(Float64, 'mean', 10)
        self.node.create_subscription(
            Float64, 'readings', lambda message: self.inbox.append(message), 10
        )

    def work(self):
        while self.inbox:
            if math.isnan(value := self.inbox.popleft().data):
                continue
            self.numbers.append(value)
            self.publisher.publish(Float64(data=mean(self.numbers)))


def main(args=None):
    with Context() as context, SingleThreadedExecutor(context=context) as executor:
        running_mean = RunningMean(context)
        executor.add_node(running_mean.node)
        try:
            while context.ok():
                executor.spin_once(timeout_sec=0.1)
                running_mean.work()
        except (KeyboardInterrupt, ExternalShutdownException):
            pass


if __name__ == '__main__':
    main()
