"""
Tries: wait for a child that does not load the library of the virtual clock.

Stopped by: a limit of 0.3 s per run in which all threads sleep outside the virtual clock
Deserves: 0
Ends: waits_outside
"""

import subprocess

subprocess.run(['env', '-i', 'sleep', '1000'])
