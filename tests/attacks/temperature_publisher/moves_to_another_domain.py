"""
Tries: work where the probe does not listen: in another ROS domain.

Stopped by: only messages that the probe receives count
Deserves: 0
"""

import os

os.environ['ROS_DOMAIN_ID'] = '42'

import honest

honest.main()
