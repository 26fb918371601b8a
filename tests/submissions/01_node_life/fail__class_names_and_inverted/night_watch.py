import rclpy
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.number = 0
        self.create_timer(1.0, self.report)

    def report(self):
        self.number += 1
        if self.number % 5:
            self.get_logger().warning(f'Watch {self.number}: relief!')
        else:
            self.get_logger().info(f'Watch {self.number}')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(NightWatch())


if __name__ == '__main__':
    main()
