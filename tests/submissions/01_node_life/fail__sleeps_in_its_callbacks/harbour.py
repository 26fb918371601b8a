import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Lookout(Node):
    def __init__(self):
        super().__init__('lookout', namespace='harbour')
        self.create_timer(1.0, self.report)

    def report(self):
        self.get_logger().info('I see the sea.')


class Keeper(Node):
    def __init__(self):
        super().__init__('keeper', namespace='harbour')
        self.create_timer(2.0, self.report)

    def report(self):
        time.sleep(1.5)
        self.get_logger().info('The light burns.')


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    for node in (Lookout(), Keeper()):
        executor.add_node(node)
    executor.spin()


if __name__ == '__main__':
    main()
