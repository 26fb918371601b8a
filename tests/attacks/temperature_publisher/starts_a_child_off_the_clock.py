"""
Tries: wait for a child that does not load the library of the virtual clock.

Stopped by: a limit of 5 s per run in which no process computes
Deserves: 0
Ends: waits_outside
"""

import subprocess

subprocess.run(['env', '-i', 'sleep', '1000'])
