import rclpy
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, period):
        super().__init__(name, namespace='harbour')
        self.create_timer(period, lambda: self.get_logger().info('here'))


def main(args=None):
    rclpy.init(args=args)
    lookout = Watcher('lookout', 1.0)
    keeper = Watcher('keeper', 2.0)
    rclpy.spin(lookout)
    rclpy.spin(keeper)


if __name__ == '__main__':
    main()
