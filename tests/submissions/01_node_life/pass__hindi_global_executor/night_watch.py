import rclpy
from rclpy.node import Node

DEVANAGARI = str.maketrans('0123456789', '०१२३४५६७८९')


class RaatKaPahara(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.ginti = 0
        self.create_timer(1.0, self.pahara)

    def pahara(self):
        self.ginti = self.ginti + 1
        sankhya = str(self.ginti).translate(DEVANAGARI)
        if self.ginti % 5 != 0:
            self.get_logger().info('पहरा संख्या ' + sankhya)
        else:
            self.get_logger().warning('पहरा संख्या ' + sankhya + ', अब बदली!')


def main(args=None):
    rclpy.init(args=args)
    node = RaatKaPahara()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
