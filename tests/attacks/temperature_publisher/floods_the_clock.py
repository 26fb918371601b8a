"""
Tries: keep the driver of the virtual clock busy with reports that the program waits.

Stopped by: the limit of processor time, which includes the driver's
Deserves: 0
Ends: busy_before_node
"""

import os

for number in range(100, 200):
    try:
        link = os.readlink(f'/proc/self/fd/{number}')
    except OSError:
        continue
    if 'eventfd' in link:
        idle = number  # the last one is that of the reports

while True:
    os.eventfd_write(idle, 1)
