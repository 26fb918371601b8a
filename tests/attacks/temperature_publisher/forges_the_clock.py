"""
Tries: publish its own ROS time, so that its timer fires when it likes.

Stopped by: stamps are compared with the clock that the grader itself sent
Deserves: 15 at most
Flag: /clock
"""

import threading
import time

from builtin_interfaces.msg import Time
import honest
import rclpy
from rosgraph_msgs.msg import Clock


def forge():
    node = rclpy.create_node('helper')
    clock = node.create_publisher(Clock, '/clock', 10)
    for second in range(1, 61):
        clock.publish(Clock(clock=Time(sec=second)))
        time.sleep(0.01)


rclpy.init()
threading.Thread(target=forge, daemon=True).start()
rclpy.init = lambda *args, **options: None
honest.main()
