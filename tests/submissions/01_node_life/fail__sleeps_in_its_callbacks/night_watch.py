import time

import rclpy
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.number = 0
        self.create_timer(1.0, self.report)

    def report(self):
        self.number += 1
        log = self.get_logger()
        if self.number % 5 == 0:
            log.warning(f'Watch {self.number}')
        else:
            log.info(f'Watch {self.number}')
        time.sleep(2.0)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(NightWatch())


if __name__ == '__main__':
    main()
