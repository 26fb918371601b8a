import rclpy
from rclpy.node import Node


class Nachtwache(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.stunde = 0
        self.timer = self.create_timer(1.0, self.rufen)

    def rufen(self):
        self.stunde = self.stunde + 1
        text = f'Die Uhr hat {self.stunde} geschlagen'
        if self.stunde % 5 == 0:
            self.get_logger().warning(text)
        else:
            self.get_logger().info(text)


def main(args=None):
    rclpy.init(args=args)
    node = Nachtwache()
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.05)


if __name__ == '__main__':
    main()
