"""
Tries: show a node and its publisher, then end with exit code 0 before anything is measured.

Stopped by: what a program shows before it can be asked counts for nothing
Deserves: 0
"""

import honest
import rclpy

rclpy.init()
node = honest.TemperaturePublisher()
node.tick()
print('all checks passed')
