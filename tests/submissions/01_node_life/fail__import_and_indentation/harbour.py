import rclpy
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period_s):
        super().__init__(name, namespace='harbour')
        self.create_timer(period_s, self.report)

    def report(self):
        self.get_logger().info('All quiet.')


def main(args=None):
    rclpy.init(args=args)
    lookout = Watcher('lookout', 1.0)
    keeper = Watcher('keeper', 2.0)
    executor = SingleThreadedExecutor()
    executor.add_node(lookout)
    executor.add_node(keeper)
    executor.spin()


if __name__ == '__main__':
    main()
