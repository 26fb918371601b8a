"""
Tries: load a different RMW with the environment variable.

Stopped by: rclpy is loaded before the program begins, so the variable comes too late
Deserves: 15
"""

import os

os.environ['RMW_IMPLEMENTATION'] = 'rmw_cyclonedds_cpp'

import honest

honest.main()
