"""
Tries: announce a node of the right name, and have none.

Stopped by: a node that answers nothing is no node to wait for; without messages there are no
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
