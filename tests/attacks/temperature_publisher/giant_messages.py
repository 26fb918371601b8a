"""
Tries: make the observer swallow messages of many megabytes.

Stopped by: only the size of a large message is recorded; the probe has a memory limit too
Deserves: 15 at most
"""

import rclpy

from temp_monitor_pkg.msg import Temperature

rclpy.init()
node = rclpy.create_node('temperature_publisher')
publisher = node.create_publisher(Temperature, 'temperature_topic', 10)


def tick():
    publisher.publish(Temperature(unit='x' * (16 << 20), sensor_id='temp_sensor_01'))


node.create_timer(1.0, tick)
rclpy.spin(node)
