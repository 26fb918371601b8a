"""
Tries: drown the observer in the discovery of three thousand publishers.

Stopped by: the limit of processor time; if the observer gave up, there would be no verdict
Deserves: 15 at most
Flag: more than 100 publishers
"""

import honest
import rclpy
from std_msgs.msg import Empty

rclpy.init()
node = honest.TemperaturePublisher()
crowd = [node.create_publisher(Empty, f'a{number}', 1) for number in range(3000)]
rclpy.spin(node)
