import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.n = 0
        self.create_timer(1, self.tick)

    def tick(self):
        self.n += 1
        match divmod(self.n, 5):
            case (fives, 0):
                self.get_logger().warn(f'watch={self.n:03d} level=high fives={fives}')
            case _:
                self.get_logger().info(f'watch={self.n:03d} level=low')


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(night_watch := NightWatch())
    except (KeyboardInterrupt, ExternalShutdownException):
        night_watch.destroy_node()
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
