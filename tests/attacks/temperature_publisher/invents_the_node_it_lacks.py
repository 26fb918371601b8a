"""
Tries: announce a node with the right name without creating it.

Stopped by: the probe does not wait for a node that never answers; without messages there are no
 points
Deserves: 4 at most
"""

import participants
import rclpy

rclpy.init()
node = rclpy.create_node('somebody_else')
send = participants.channel(node)

send(b'nobodyatall!', ['temperature_publisher'])
rclpy.spin(node)
