"""
Tries: drown the probe in datagrams, so that it receives nothing else.

Stopped by: limits of processor time; silence gets no points
Deserves: 15 at most
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
