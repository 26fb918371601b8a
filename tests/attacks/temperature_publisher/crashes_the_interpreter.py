"""
Tries: die of a segmentation fault.

Deserves: 0
"""

import ctypes

ctypes.string_at(0)
