"""
Tries: compute forever in short-lived children, whose exit codes and processor times are lost.

Stopped by: the watchdog estimates the processor time of all children from those that it sees
Deserves: 5 at most
Ends: cpu_limit
"""

import os
import signal
import time

import honest

signal.signal(signal.SIGCHLD, signal.SIG_IGN)


def tick(self):
    while True:
        if os.fork() == 0:
            while time.process_time() < 0.03:
                pass
            os._exit(0)
        try:
            os.wait()
        except ChildProcessError:  # the child has ended, and left no exit code
            continue


honest.TemperaturePublisher.tick = tick
honest.main()
