"""
Tries: bury the graph under hundreds of publishers.

Stopped by: all are counted, a few hundred are listed, and the rest of the run is unaffected
Deserves: 15 at most
Flag: more than 100 publishers
"""

import honest
import rclpy
from std_msgs.msg import Empty

rclpy.init()
node = honest.TemperaturePublisher()
crowd = [node.create_publisher(Empty, f'a{number}', 1) for number in range(300)]
rclpy.spin(node)
