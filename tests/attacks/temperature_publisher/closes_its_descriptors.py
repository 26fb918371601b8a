"""
Tries: close the standard descriptors, so that whoever waits for them waits for ever or breaks.

Stopped by: the end of a process is seen through a descriptor of the kernel, not through its
    pipes
Deserves: 15
"""

import os

import honest

nothing = os.open('/dev/null', os.O_RDWR)
for number in range(3):
    os.dup2(nothing, number)
honest.main()
