"""
Tries: stop its own process with a signal, so that the grader waits for it.

Stopped by: a limit of 0.3 s per run in which all threads sleep outside the virtual clock
Deserves: 0
Ends: waits_outside
"""

import os
import signal

os.kill(os.getpid(), signal.SIGSTOP)
