import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period_s):
        super().__init__(name, namespace='harbour')
        self.get_logger().info('On duty.')
        self.create_timer(period_s, self.report)

    def report(self):
        self.get_logger().info('All quiet.', throttle_duration_sec=5.0)


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Watcher('lookout', 1.0))
    executor.add_node(Watcher('keeper', 2.0))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
