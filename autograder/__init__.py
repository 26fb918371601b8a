"""
Run untrusted student code, and judge the ROS messages and log lines that it sends.

Data flows between the folders as follows::

    submission -> runs (with sandboxes and probe) -> recording -> judging -> gradebook, classroom
"""
