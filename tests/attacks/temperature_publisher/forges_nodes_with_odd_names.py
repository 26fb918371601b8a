"""
Tries: announce nodes of a participant that does not exist, with markup, terminal codes and
 formulas as names (through the middleware's own discovery topic).

Stopped by: the probe accepts any name, but calls only nodes whose names ROS 2 allows; pages escape
 all names
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
