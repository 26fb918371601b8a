"""
Tries: work where the probe does not listen: in another ROS domain.

Stopped by: only messages that the probe receives count; the open ports reveal the domain
Deserves: 0
Flag: ROS domain 42
"""

import os

os.environ['ROS_DOMAIN_ID'] = '42'

import honest

honest.main()
