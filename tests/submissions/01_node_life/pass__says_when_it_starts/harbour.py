#!/usr/bin/env python3
import rclpy
from rclpy.node import Node
from rclpy.executors import SingleThreadedExecutor


class Lookout(Node):

    def __init__(self):
        super().__init__('lookout', namespace='harbour')
        self.timer_ = self.create_timer(1.0, self.timer_callback)
        self.get_logger().info('Lookout has been started.')

    def timer_callback(self):
        self.get_logger().info('I see the sea.')


class Keeper(Node):

    def __init__(self):
        super().__init__('keeper', namespace='harbour')
        self.timer_ = self.create_timer(2.0, self.timer_callback)
        self.get_logger().info('Keeper has been started.')

    def timer_callback(self):
        self.get_logger().info('The light is burning.')


def main(args=None):
    rclpy.init(args=args)
    lookout = Lookout()
    keeper = Keeper()
    executor = SingleThreadedExecutor()
    executor.add_node(lookout)
    executor.add_node(keeper)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
