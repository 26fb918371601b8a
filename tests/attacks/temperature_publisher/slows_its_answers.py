"""
Tries: answer the round trips that hold the steps together from a thread of its own, before the
    work is done.

Stopped by: the grader sees from outside whether a thread of the program still runs
Deserves: 15 at most
"""

import threading

import honest
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor

rclpy.init()
node = honest.TemperaturePublisher()


def late(publish=honest.TemperaturePublisher.tick):
    threading.Timer(0.02, publish, [node]).start()


node.timer.cancel()
node.timer = node.create_timer(1.0, late, callback_group=ReentrantCallbackGroup())
executor = MultiThreadedExecutor(4)
executor.add_node(node)
executor.spin()
