from collections import deque

import numpy as np
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class Mean(Node):
    seen: deque = deque()

    def __init__(self):
        Node.__init__(self, node_name='running_mean', enable_rosout=True)
        self.pub = self.create_publisher(msg_type=Float64, topic='mean', qos_profile=10)
        self.sub = self.create_subscription(
            msg_type=Float64, topic='readings', callback=self.__call__, qos_profile=10
        )

    def __call__(self, message: Float64) -> None:
        match message.data:
            case float(x) if not np.isnan(x):
                self.seen.append(x)
                self.pub.publish(Float64(data=float(np.mean(list(self.seen)))))
            case _:
                self.get_logger().debug('ignored')


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor()
    executor.add_node(Mean())
    executor.spin()


if __name__ == '__main__':
    main()
