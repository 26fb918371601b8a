"""
Tries: keep the driver of the virtual clock busy with messages on its socket.

Stopped by: the limit of processor time, which includes the driver's
Deserves: 0
Flag: ended by the grader
"""

import os
import socket

clock = socket.socket(fileno=os.dup(int(os.environ['VIRTUAL_CLOCK'])))
while True:
    clock.send(b'?')
