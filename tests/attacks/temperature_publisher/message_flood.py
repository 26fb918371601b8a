"""
Tries: bury the observer under messages.

Stopped by: the probe stops recording after 20000 events
Deserves: 5 at most
"""

import rclpy

from temp_monitor_pkg.msg import Temperature

rclpy.init()
node = rclpy.create_node('temperature_publisher')
publisher = node.create_publisher(Temperature, 'temperature_topic', 10)
while True:
    publisher.publish(Temperature())
    rclpy.spin_once(node, timeout_sec=0)
