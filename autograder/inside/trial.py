"""
Report whether a program can read a file of the grader, and whether its time is virtual.

Usage: run_node.py trial.py FILE NOW.  The grader runs this program once to try an isolation mode,
and compares the printed word.
"""

import sys
import time

import rclpy  # noqa: F401 - as in every program

try:
    open(sys.argv[1]).close()
except OSError:
    print('in' if abs(time.time() - float(sys.argv[2])) < 3600 else 'real')
else:
    print('open')
