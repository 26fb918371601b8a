import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, hz):
        super().__init__(name, namespace='harbour')
        self.create_timer(hz, self.report)

    def report(self):
        self.get_logger().info('All quiet.')


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Watcher('lookout', 1.0))
    executor.add_node(Watcher('keeper', 0.5))  # 0.5 Hz
    executor.spin()


if __name__ == '__main__':
    main()
