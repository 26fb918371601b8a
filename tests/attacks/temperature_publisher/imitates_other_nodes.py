"""
Tries: confuse the observer with nodes and services of the same name.

Stopped by: every node with the name must answer; duplicates are flagged
Deserves: 15 at most
Flag: same name
"""

import honest
import rclpy

rclpy.init()
twins = [rclpy.create_node('temperature_publisher') for _ in range(3)]
rclpy.init = lambda *args, **options: None
honest.main()
