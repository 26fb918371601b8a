import math
import threading

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    def __init__(self):
        super().__init__('running_mean')
        self.lock = threading.Lock()
        self.values = []
        self.publisher = self.create_publisher(Float64, '/mean', 10)
        self.create_subscription(
            Float64, '/readings', self.take, 10, callback_group=MY_GROUP
        )
        self.create_subscription(Float64, '/mean', self.show, 10)

    def take(self, message):
        with self.lock:
            if math.isnan(message.data):
                self.get_logger().warning('NaN ignored')
                return
            self.values.append(message.data)
            mean = math.fsum(self.values) / len(self.values)
            self.publisher.publish(Float64(data=mean))

    def show(self, message):
        self.get_logger().info(f'mean is {message.data:.3f}')


MY_GROUP = MutuallyExclusiveCallbackGroup()


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor()
    executor.add_node(RunningMean())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
