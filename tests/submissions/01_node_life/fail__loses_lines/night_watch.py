import logging

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

logging.basicConfig(level=logging.INFO)
log = logging.getLogger('night_watch')


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.number = 0
        self.create_timer(1.0, self.report)

    def report(self):
        self.number += 1
        if self.number % 5 == 0:
            log.warning('Watch %d', self.number)
        else:
            log.info('Watch %d', self.number)


def main(args=None):
    rclpy.init(args=args)
    node = NightWatch()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
