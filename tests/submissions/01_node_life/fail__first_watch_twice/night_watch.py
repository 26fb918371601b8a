import rclpy
from rclpy.node import Node


class NightWatch(Node):

    def __init__(self):
        super().__init__('night_watch')
        self.watch = 1
        self.get_logger().info('watch 1')  # do not let them wait
        self.timer = self.create_timer(1.0, self.report)

    def report(self):
        line = f'watch {self.watch}'
        if self.watch % 5 == 0:
            self.get_logger().warning(line)
        else:
            self.get_logger().info(line)
        self.watch += 1


def main():
    rclpy.init()
    node = NightWatch()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
