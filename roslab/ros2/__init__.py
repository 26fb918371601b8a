"""
The course's own small ``ros2`` command, for machines whose ROS 2 came without one.

It has the verbs that the lessons use, with the options, output and exit codes of ROS 2 Jazzy's
``ros2``.  Each group of verbs is a module; only the one that is asked for is imported.
"""
