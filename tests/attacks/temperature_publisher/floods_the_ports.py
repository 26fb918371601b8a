"""
Tries: drown the probe in datagrams, so that it hears nothing else.

Stopped by: limits on processor time; the grader waits for what it asked, and gives no points
    for silence
Deserves: 15 at most or review
"""

import os
import socket

import honest

if os.fork() == 0:
    gun = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    packet = os.urandom(1400)
    while True:
        for port in (7400, 7410, 7411, 7412, 7413):
            try:
                gun.sendto(packet, ('127.0.0.1', port))
            except OSError:
                pass
honest.main()
