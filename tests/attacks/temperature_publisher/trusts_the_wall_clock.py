"""
Tries: ignore simulated time: switch use_sim_time off and stamp with the time of day.

Stopped by: the probe moves a minute of simulated time in less than a second of real time
Deserves: 9
"""

import honest
import rclpy
from rclpy.parameter import Parameter

rclpy.init()
node = honest.TemperaturePublisher()
node.set_parameters([Parameter('use_sim_time', value=False)])
node.timer.cancel()
node.create_timer(0.005, node.tick)
rclpy.spin(node)
