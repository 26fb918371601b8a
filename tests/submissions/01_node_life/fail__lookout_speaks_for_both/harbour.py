import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Lookout(Node):
    def __init__(self):
        super().__init__('lookout', namespace='harbour')
        self.seconds = 0
        self.create_timer(1.0, self.report)

    def report(self):
        self.seconds += 1
        self.get_logger().info('lookout: nothing')
        if self.seconds % 2 == 0:
            self.get_logger().info('keeper: light is on')


class Keeper(Node):
    def __init__(self):
        super().__init__('keeper', namespace='harbour')


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Lookout())
    executor.add_node(Keeper())
    executor.spin()


if __name__ == '__main__':
    main()
