import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

LOOKOUT_MS = 1000
KEEPER_MS = 2000


class Watcher(Node):
    def __init__(self, name, period):
        super().__init__(name, namespace='harbour')
        self.timer = self.create_timer(period, self.report)

    def report(self):
        self.get_logger().info('report of ' + self.get_name())


def main(args=None):
    rclpy.init(args=args)
    lookout = Watcher('lookout', LOOKOUT_MS)
    keeper = Watcher('keeper', KEEPER_MS)
    executor = SingleThreadedExecutor()
    executor.add_node(lookout)
    executor.add_node(keeper)
    executor.spin()


if __name__ == '__main__':
    main()
