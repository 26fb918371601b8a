import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Lookout(Node):
    def _init_(self):
        super()._init_('lookout', namespace='harbour')
        self.create_timer(1.0, self.report)

    def report(self):
        self.get_logger().info('Nothing in sight.')


class Keeper(Node):
    def _init_(self):
        super()._init_('keeper', namespace='harbour')
        self.create_timer(2.0, self.report)

    def report(self):
        self.get_logger().info('The light is on.')


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Lookout())
    executor.add_node(Keeper())
    executor.spin()


if __name__ == '__main__':
    main()
