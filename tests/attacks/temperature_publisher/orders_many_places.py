"""
Tries: order 300 places on the virtual clock, for children that never begin.

Stopped by: a limit of 0.3 s per run in which all threads sleep outside the virtual clock
Deserves: 0
Ends: waits_outside
"""

import os
import socket
import time

clock = socket.socket(fileno=os.dup(int(os.environ['VIRTUAL_CLOCK'])))
ends = []
for _ in range(300):
    try:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    except OSError:
        break  # the limit of descriptors
    socket.send_fds(clock, [b'a'], [theirs.fileno()])
    theirs.close()
    ends.append(ours)
time.sleep(1000)
