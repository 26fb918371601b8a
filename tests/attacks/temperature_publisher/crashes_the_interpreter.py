"""
Tries: crash with a segmentation fault.

Stopped by: a separate process; an exit code is not evidence
Deserves: 0
"""

import ctypes

ctypes.string_at(0)
