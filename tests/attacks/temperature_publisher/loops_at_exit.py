"""
Tries: finish its work, but never exit.

Stopped by: the run is over when the probe is done, whatever the program still does
Deserves: 5 at most
"""

import atexit

import honest
import rclpy


@atexit.register
def forever():
    while True:
        pass


rclpy.init()
node = honest.TemperaturePublisher()
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=0.05)
