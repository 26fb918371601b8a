"""
Tries: announce nodes of a participant that does not exist, with markup, terminal codes and
    formulas as names (through the middleware's own discovery topic).

Stopped by: names are any text to the probe; it asks nodes whose name ROS 2 allows, the pages
    escape all
Deserves: 15
Flag: a name that ROS 2 does not allow
"""

import honest
import participants
import rclpy

rclpy.init()
node = honest.TemperaturePublisher()
send = participants.channel(node)

send(
    b'nobodyatall!',
    ['<script>alert(1)</script>', '\x1b[2Jred', '=1+1', '../../etc', 'x' * 250 + '!'],
)
rclpy.spin(node)
