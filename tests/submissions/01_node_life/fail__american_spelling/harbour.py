import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period_s):
        super().__init__(name, namespace='harbor')
        self.create_timer(period_s, self.report)

    def report(self):
        self.get_logger().info('All quiet in the harbor.')


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Watcher('lookout', 1.0))
    executor.add_node(Watcher('keeper', 2.0))
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
