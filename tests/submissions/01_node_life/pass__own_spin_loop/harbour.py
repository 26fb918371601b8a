import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Lookout(Node):
    def __init__(self):
        super().__init__('lookout', namespace='harbour')
        self.timer = self.create_timer(1.0, self.melde)

    def melde(self):
        self.get_logger().info('Ausguck: nichts zu sehen')


class Keeper(Node):
    def __init__(self):
        super().__init__('keeper', namespace='harbour')
        self.timer = self.create_timer(2.0, self.melde)

    def melde(self):
        self.get_logger().info('Wärter: das Licht brennt')


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    nodes = [Lookout(), Keeper()]
    for node in nodes:
        executor.add_node(node)
    while rclpy.ok():
        executor.spin_once(timeout_sec=0.1)


if __name__ == '__main__':
    main()
