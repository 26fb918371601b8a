"""
Tries: make the logger claim a level that differs from the one that it sends.

Stopped by: the level is read from /rosout, as it was sent
Deserves: 6
"""

import honest
from rclpy.impl.rcutils_logger import RcutilsLogger

RcutilsLogger.warning = RcutilsLogger.info
RcutilsLogger.warn = RcutilsLogger.info
RcutilsLogger.get_effective_level = lambda self: 30
honest.main()
