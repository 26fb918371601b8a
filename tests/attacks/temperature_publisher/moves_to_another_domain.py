"""
Tries: work where the probe does not listen: in another ROS domain.

Stopped by: only what the probe hears counts; the ports in use tell of the domain
Deserves: 0
Flag: ROS domain 42
"""

import os

os.environ['ROS_DOMAIN_ID'] = '42'

import honest

honest.main()
