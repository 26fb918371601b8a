import rclpy
from rclpy.node import Node


class Lookout(Node):
    def __init__(self):
        super().__init__('lookout', namespace='harbour')
        self.timer = self.create_timer(1.0, self.report)

    def report(self):
        self.get_logger().info('nothing to see')


class Keeper(Node):
    def __init__(self):
        super().__init__('keeper', namespace='harbour')
        self.timer = self.create_timer(2.0, self.report)

    def report(self):
        self.get_logger().info('light is on')


def main(args=None):
    rclpy.init(args=args)
    lookout = Lookout()
    rclpy.spin(lookout)
    keeper = Keeper()
    rclpy.spin(keeper)
    lookout.destroy_node()
    keeper.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
