import rclpy
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.ticks = 0
        self.timer = self.create_timer(0.05, self.tick)

    def tick(self):
        self.ticks += 1
        seconds, rest = divmod(self.ticks, 20)
        if rest:
            return
        if seconds % 5:
            self.get_logger().info(f'all is well, {seconds}')
        else:
            self.get_logger().warning(f'five more, {seconds}')


def main():
    rclpy.init()
    try:
        rclpy.spin(NightWatch())
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
