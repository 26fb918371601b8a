"""
Tries: stop its own process with a signal, so that the grader waits for it.

Stopped by: a limit of 5 s per run in which no process computes
Deserves: 0
Ends: waits_outside
"""

import os
import signal

os.kill(os.getpid(), signal.SIGSTOP)
