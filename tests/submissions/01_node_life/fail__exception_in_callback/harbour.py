import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period_s):
        super().__init__(name, namespace='harbour')
        self.create_timer(period_s, self.report)

    def report(self):
        self.get_loger().info('All quiet.')


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Watcher('lookout', 1.0))
    executor.add_node(Watcher('keeper', 2.0))
    executor.spin()


if __name__ == '__main__':
    main()
