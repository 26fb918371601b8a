"""
Tries: log endlessly while it publishes.

Stopped by: the probe stops recording after 20000 events
Deserves: 15 at most
"""

import threading

import honest
import rclpy

rclpy.init()
node = honest.TemperaturePublisher()


def talk():
    while rclpy.ok():
        node.get_logger().info('so much to say ' * 10)


threading.Thread(target=talk, daemon=True).start()
rclpy.spin(node)
