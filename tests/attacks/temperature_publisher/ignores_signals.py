"""
Tries: refuse to end.

Stopped by: SIGKILL to the first process of the pid namespace, which ends all of it
Deserves: 15
"""

import signal

import honest

for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, signal.SIG_IGN)
honest.main()
