import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class NightWatch(Node):
    done = 0

    def __init__(self, **options):
        super().__init__('night_watch', **options)
        self.create_timer(1.0, self.report)

    async def report(self):
        self.done += 1
        log = self.get_logger().get_child('bell')
        if self.done in range(0, 1000, 5):
            log.warning(f'{self.done} bells!')
            return
        log.info(f'{self.done} bells')


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(NightWatch())
    except (KeyboardInterrupt, ExternalShutdownException):
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
