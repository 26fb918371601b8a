"""
Tries: hand in a device without an end, or a socket where only root may make one.

Stopped by: only regular files are opened
Deserves: 0
Flag: something else
"""

import os
import socket
import stat

from tests.attacks.handing_in import ASSIGNMENT, NOTEBOOK


def hand_in(student, solved, blank):
    place = student / ASSIGNMENT
    place.mkdir(parents=True)
    try:
        os.mknod(place / NOTEBOOK, 0o644 | stat.S_IFCHR, os.makedev(1, 5))
    except OSError:
        with socket.socket(socket.AF_UNIX) as made:
            made.bind(f'/proc/self/fd/{os.open(place, os.O_RDONLY)}/{NOTEBOOK}')
