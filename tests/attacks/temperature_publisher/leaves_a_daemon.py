"""
Tries: leave a process behind that outlives the run and ignores signals.

Stopped by: a pid namespace: it ends as a whole
Deserves: 15
Flag: other processes
"""

import os
import signal

import honest

if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        for number in range(1, 65):
            try:
                signal.signal(number, signal.SIG_IGN)
            except (OSError, ValueError):
                pass
        os.execvp('sleep', ['sleep', '86397'])
    os._exit(0)
honest.main()
