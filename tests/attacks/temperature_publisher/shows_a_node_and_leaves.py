"""
Tries: show a node and its publisher, then end with exit code 0 before anything is measured.

Stopped by: nothing counts that a program shows before the probe can query it
Deserves: 0
"""

import honest
import rclpy

rclpy.init()
node = honest.TemperaturePublisher()
node.tick()
print('all checks passed')
