import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period_s):
        super().__init__(name, namespace='harbour')
        self.timer = self.create_timer(period_s, self.report)

    def report(self):
        self.get_logger().info('All quiet.')


def main(args=None):
    rclpy.init(args=args)
    lookout = Watcher('lookout', 1.0)
    keeper = Watcher('keeper', 2.0)
    timer1 = lookout.create_timer(1.0, lookout.report)
    timer2 = keeper.create_timer(2.0, keeper.report)
    executor = SingleThreadedExecutor()
    executor.add_node(lookout)
    executor.add_node(keeper)
    executor.spin()


if __name__ == '__main__':
    main()
