"""
Tries: let another node's logger speak for it.

Stopped by: only lines from the logger of the required node count
Deserves: 2
"""

import honest
import rclpy

rclpy.init()
node = honest.NightWatch()
other = rclpy.create_node('ghost')
node.get_logger = other.get_logger
rclpy.spin(node)
