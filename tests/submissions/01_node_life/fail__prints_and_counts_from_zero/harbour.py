import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period):
        super().__init__(name, namespace='harbour')
        self.create_timer(period, lambda: print(name, 'reports', flush=True))


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Watcher('lookout', 1.0))
    executor.add_node(Watcher('keeper', 2.0))
    executor.spin()


if __name__ == '__main__':
    main()
