"""
Implement a small ``ros2`` command, for installations of ROS 2 without one.

It has the verbs that the lessons use, with the options, output and exit codes of ROS 2 Jazzy's
``ros2``.  Each group of verbs is a separate module, imported only when it is needed.
"""
