"""
Tries: ignore the ROS clock: switch use_sim_time off and stamp with the time of day.

Stopped by: ROS time runs faster or slower than the time of day
Deserves: 9
"""

import honest
import rclpy
from rclpy.parameter import Parameter

rclpy.init()
node = honest.TemperaturePublisher()
node.set_parameters([Parameter('use_sim_time', value=False)])
rclpy.spin(node)
