import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


class Inspector(Node):

    def __init__(self):
        super().__init__('inspector')
        self.group = ReentrantCallbackGroup()
        self.publisher_ = self.create_publisher(String, 'results', 10)
        self.alive_ = self.create_publisher(Empty, 'alive', 10)
        self.subscription = self.create_subscription(
            String, 'pictures', self.listener_callback, 10)
        self.timer = self.create_timer(0.5, self.timer_callback, callback_group=self.group)

    def timer_callback(self):
        self.alive_.publish(Empty())

    def listener_callback(self, msg):
        self.get_logger().info('I see: "%s"' % msg.data)
        result = String()
        result.data = inspect(msg.data)
        self.publisher_.publish(result)


def main(args=None):
    rclpy.init(args=args)
    inspector = Inspector()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(inspector)
    executor.spin()
    inspector.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
