"""
Tries: read the name of the grader's node from the graph and use it for a node of its own, so
    that this one is overlooked.

Stopped by: the probe knows its endpoints by the id of its participant, and counts the nodes of
    its name
Deserves: 15 at most
Flag: name of the grader's own node
"""

import threading
import time

import honest
import rclpy
from rclpy.executors import MultiThreadedExecutor

from temp_monitor_pkg.msg import Temperature

rclpy.init()
node = honest.TemperaturePublisher()
executor = MultiThreadedExecutor(2)
executor.add_node(node)
twins = []


def imitate():
    while not twins:
        for name in node.get_node_names():
            if name not in ('temperature_publisher', '_NODE_NAME_UNKNOWN_'):
                twin = rclpy.create_node(name)
                twin.create_publisher(Temperature, 'temperature_topic', 1)
                twins.append(twin)
                executor.add_node(twin)
                return
        time.sleep(0.01)


threading.Thread(target=imitate, daemon=True).start()
executor.spin()
