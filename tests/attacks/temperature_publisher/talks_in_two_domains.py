"""
Tries: behave honestly, but also join a second domain, where other programs may run.

Stopped by: the sandbox has a separate network, without other programs in any domain
Deserves: 15
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
