"""
Tries: die of a segmentation fault.

Stopped by: a process of its own; an exit code is no evidence
Deserves: 0
"""

import ctypes

ctypes.string_at(0)
