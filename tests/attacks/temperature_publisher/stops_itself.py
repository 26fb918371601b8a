"""
Tries: stop its own process by a signal, and be waited for.

Stopped by: 5 s of the whole run in which nobody computes
Deserves: 0
Ends: waits_outside
"""

import os
import signal

os.kill(os.getpid(), signal.SIGSTOP)
