"""
Tries: stop its own process by a signal, and be waited for.

Stopped by: 0.3 s in which virtual time stands still and nobody computes
Deserves: 0
Ends: waits_outside
"""

import os
import signal

os.kill(os.getpid(), signal.SIGSTOP)
