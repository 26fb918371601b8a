"""
Tries: wait for a child that does not load the library of the virtual clock.

Stopped by: 5 s of the whole run in which nobody computes
Deserves: 0
Ends: waits_outside
"""

import subprocess

subprocess.run(['env', '-i', 'sleep', '1000'])
