import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Lookout(Node):
    def __init__(self):
        super().__init__('Lookout', namespace='harbour')
        self.create_timer(1.0, lambda: self.get_logger().info('ship ahoy'))


class Keeper(Node):
    def __init__(self):
        super().__init__('Keeper', namespace='harbour')
        self.create_timer(2.0, lambda: self.get_logger().info('light on'))


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    for node in (Lookout(), Keeper()):
        executor.add_node(node)
    executor.spin()


if __name__ == '__main__':
    main()
