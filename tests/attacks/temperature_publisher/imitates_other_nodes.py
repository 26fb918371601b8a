"""
Tries: confuse the observer with nodes of the same name and with services it may ask.

Stopped by: every node of a name has to answer; twins are flagged
Deserves: 15 at most
Flag: same name
"""

import honest
import rclpy

rclpy.init()
twins = [rclpy.create_node('temperature_publisher') for _ in range(3)]
rclpy.init = lambda *args, **options: None
honest.main()
