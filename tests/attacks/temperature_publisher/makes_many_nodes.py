"""
Tries: make the probe ask twenty nodes at each step.

Stopped by: limits of time; every node has to answer
Deserves: 15 at most
"""

import honest
import rclpy
from rclpy.executors import SingleThreadedExecutor

rclpy.init()
executor = SingleThreadedExecutor()
executor.add_node(honest.TemperaturePublisher())
for number in range(20):
    executor.add_node(rclpy.create_node(f'bystander_{number}'))
executor.spin()
