"""
Tries: close the standard descriptors, so that a process that reads them waits forever or fails.

Stopped by: the grader sees the end of a process through a pidfd, not through its pipes
Deserves: 15
"""

import os

import honest

nothing = os.open('/dev/null', os.O_RDWR)
for number in range(3):
    os.dup2(nothing, number)
honest.main()
