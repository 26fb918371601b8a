import math
from queue import Queue
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class RunningMean(Node):
    def __init__(self):
        super().__init__('running_mean')
        self.inbox = Queue()
        self.pub = self.create_publisher(Float64, 'mean', 10)
        self.create_subscription(Float64, 'readings', self.inbox.put, 10)

    def work(self):
        count, total = 0, 0.0
        while True:
            value = self.inbox.get().data
            if math.isnan(value):
                continue
            count, total = count + 1, total + value
            self.pub.publish(Float64(data=total / count))


def main(args=None):
    rclpy.init(args=args)
    node = RunningMean()
    threading.Thread(target=node.work, daemon=True).start()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
