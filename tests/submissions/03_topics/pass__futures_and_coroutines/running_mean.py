from fractions import Fraction
import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    """Exact arithmetic: no rounding until the very end."""

    def __init__(self):
        super().__init__('running_mean')
        self.exact = []
        self.pub = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.take, 10)

    async def take(self, message):
        if math.isfinite(message.data):
            await self.answer(Fraction(message.data))

    async def answer(self, number):
        self.exact.append(number)
        self.pub.publish(Float64(data=float(sum(self.exact) / len(self.exact))))


def main(args=None):
    rclpy.init(args=args)
    node = RunningMean()
    try:
        rclpy.spin_until_future_complete(node, rclpy.Future())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
