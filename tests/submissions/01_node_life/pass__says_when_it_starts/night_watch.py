#!/usr/bin/env python3
import rclpy
from rclpy.node import Node


class NightWatchNode(Node):

    def __init__(self):
        super().__init__('night_watch')
        self.counter_ = 0
        self.get_logger().info('Night watch has been started.')
        self.timer_ = self.create_timer(1.0, self.timer_callback)

    def timer_callback(self):
        self.counter_ += 1
        if self.counter_ % 5 == 0:
            self.get_logger().warn('Watch number ' + str(self.counter_))
        else:
            self.get_logger().info('Watch number ' + str(self.counter_))


def main(args=None):
    rclpy.init(args=args)
    node = NightWatchNode()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
