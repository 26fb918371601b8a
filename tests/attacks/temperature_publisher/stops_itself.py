"""
Tries: stop its own process by a signal, and be waited for.

Stopped by: the probe waits ten seconds for a node, of the time in which nobody wants a
    processor
Deserves: 0
"""

import os
import signal

os.kill(os.getpid(), signal.SIGSTOP)
