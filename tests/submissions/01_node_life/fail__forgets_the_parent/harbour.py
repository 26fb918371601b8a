import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period_s):
        self.name = name
        self.period_s = period_s
        self.timer = self.create_timer(self.period_s, self.report)

    def report(self):
        self.get_logger().info(self.name)


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
