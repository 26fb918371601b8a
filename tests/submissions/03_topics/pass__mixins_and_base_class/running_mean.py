from functools import wraps
import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


def without_nan(callback):
    """Call back for numbers only."""

    @wraps(callback)
    def guarded(self, message):
        if not math.isnan(message.data):
            callback(self, message)

    return guarded


class Statistics:
    def __init__(self):
        self._mean, self._n = 0.0, 0

    def __iadd__(self, value):
        self._n += 1
        self._mean += (value - self._mean) / self._n
        return self

    def __float__(self):
        return self._mean


class RunningMean(Node):
    def __init__(self):
        super().__init__('running_mean')
        self.statistics = Statistics()
        self.publisher = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.take, 10)

    @without_nan
    def take(self, message):
        self.statistics += message.data
        self.publisher.publish(Float64(data=float(self.statistics)))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(RunningMean())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
