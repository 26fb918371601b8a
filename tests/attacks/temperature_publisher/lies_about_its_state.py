"""
Tries: call itself a sleeping process with a name full of brackets, to mislead readers of /proc.

Stopped by: the grader reads the fields after the last bracket
Deserves: 0
Flag: busy_before_node
"""

import ctypes

ctypes.CDLL(None).prctl(15, b') S 1 (0 0 0 0', 0, 0, 0)
while True:
    pass
