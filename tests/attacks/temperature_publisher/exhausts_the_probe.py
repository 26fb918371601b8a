"""
Tries: send a message whose record is larger than the probe's memory.

Stopped by: the probe ends the run with the limit of what is recorded
Deserves: 5 at most
Ends: too_much_recorded
"""

import rclpy

from temp_monitor_pkg.msg import Temperature

rclpy.init()
node = rclpy.create_node('temperature_publisher')
publisher = node.create_publisher(Temperature, 'temperature_topic', 10)


def tick():
    # Each character takes six bytes in JSON.
    publisher.publish(Temperature(unit='\x01' * (170 << 20), sensor_id='temp_sensor_01'))


node.create_timer(1.0, tick)
rclpy.spin(node)
