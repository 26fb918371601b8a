"""An honest night watch, which attacks import and modify."""

import rclpy
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.count = 0
        self.timer = self.create_timer(1.0, self.tick)

    def tick(self):
        self.count += 1
        log = self.get_logger()
        (log.warning if self.count % 5 == 0 else log.info)(f'watch {self.count}')


def main():
    rclpy.init()
    rclpy.spin(NightWatch())
