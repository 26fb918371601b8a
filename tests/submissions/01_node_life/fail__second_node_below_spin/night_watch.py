import rclpy
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.done = 0
        self.timer = self.create_timer(1.0, self.report)

    def report(self):
        fifth = self.done % 5 == 0
        self.done += 1
        if fifth:
            self.get_logger().warning(f'Watch {self.done} is over, wake the next one')
        else:
            self.get_logger().info(f'Watch {self.done} is over')


def main(args=None):
    rclpy.init(args=args)
    node = NightWatch()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
