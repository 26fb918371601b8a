import rclpy
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.number = 0
        self.timer1 = self.create_timer(1.0, self.report)
        self.timer2 = self.create_timer(5.0, self.warn)

    def report(self):
        self.number += 1
        self.get_logger().info(f'watch {self.number}')

    def warn(self):
        self.get_logger().warning(f'watch {self.number} is a fifth one')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(NightWatch())


if __name__ == '__main__':
    main()
