"""
Tries: print what a logger would print.

Stopped by: only /rosout counts
Deserves: 2
"""

import rclpy
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.count = 0
        self.create_timer(1.0, self.tick)

    def tick(self):
        self.count += 1
        level = 'WARN' if self.count % 5 == 0 else 'INFO'
        print(f'[{level}] [1.0] [north.night_watch]: watch {self.count}', flush=True)


rclpy.init()
rclpy.spin(NightWatch())
