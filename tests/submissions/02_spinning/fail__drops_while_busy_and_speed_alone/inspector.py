from threading import Lock
import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


class Inspector(Node):
    def __init__(self):
        super().__init__('inspector')
        everybody = ReentrantCallbackGroup()
        self.one_at_a_time = Lock()
        self.alive = self.create_publisher(Empty, 'alive', 10)
        self.results = self.create_publisher(String, 'results', 10)
        self.create_timer(0.5, self.beat, callback_group=everybody)
        self.create_subscription(
            String, 'pictures', self.look, 10, callback_group=everybody)

    def beat(self):
        self.alive.publish(Empty())

    def look(self, message):
        if self.one_at_a_time.locked():
            return
        with self.one_at_a_time:
            found = inspect(message.data)
            self.results.publish(String(data=found))


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=8)
    executor.add_node(Inspector())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
