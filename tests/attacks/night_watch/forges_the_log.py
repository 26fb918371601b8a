"""
Tries: publish ready-made log lines on /rosout directly, without a logger or a timer.

Stopped by: lines have to come once a second of the virtual clock; a second publisher on /rosout is
    flagged
Deserves: 2
Flag: /rosout
"""

from rcl_interfaces.msg import Log
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile

rclpy.init()
node = rclpy.create_node('night_watch')
qos = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
publisher = node.create_publisher(Log, '/rosout', qos)
name = node.get_fully_qualified_name().strip('/').replace('/', '.')
for number in range(1, 2000):
    level = 30 if number % 5 == 0 else 20
    publisher.publish(Log(name=name, level=level, msg=f'count {number * 7 + 1000}'))
rclpy.spin(node)
