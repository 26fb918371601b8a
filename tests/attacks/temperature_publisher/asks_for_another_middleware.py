"""
Tries: load another RMW, by the environment variable.

Stopped by: there is no other in the sandbox; and the probe would not hear it
Deserves: 0
"""

import os

os.environ['RMW_IMPLEMENTATION'] = 'rmw_cyclonedds_cpp'

import honest

honest.main()
