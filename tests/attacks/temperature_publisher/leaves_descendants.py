"""
Tries: work in a grandchild, and end the process that the grader started.

Stopped by: the end of the program is the end of its sandbox
Deserves: 15 at most
"""

import os

import honest

if os.fork():
    os._exit(0)
os.setsid()
if os.fork():
    os._exit(0)
honest.main()
