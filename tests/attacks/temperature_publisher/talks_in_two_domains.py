"""
Tries: be honest here and take part in a second domain, where others may be.

Stopped by: the network is the sandbox's own; there is nobody in any domain of it
Deserves: 15
Flag: ROS domain 7
"""

import honest
import rclpy
from rclpy.context import Context

other = Context()
rclpy.init(context=other, domain_id=7)
spy = rclpy.create_node('spy', context=other)
if [name for name in spy.get_node_names() if name != 'spy']:
    print('REACHED', spy.get_node_names())
honest.main()
