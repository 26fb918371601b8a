"""
Tries: make the run long by a thread that sleeps a microsecond at a time.

Stopped by: the limit of processor time; sleeps have the grain of Linux's timers, 50 us
Deserves: 15 at most
Ends: cpu_limit
"""

import threading
import time

import honest


def doze():
    while True:
        time.sleep(1e-6)


threading.Thread(target=doze, daemon=True).start()
honest.main()
