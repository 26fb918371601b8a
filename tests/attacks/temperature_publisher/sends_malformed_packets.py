"""
Tries: crash the probe with malformed RTPS packets, on every port it may have.

Stopped by: the probe is a disposable process; if packets crash it, the program is responsible
Deserves: 15 at most
"""

import random
import socket
import threading

import honest

PORTS = [7400, 7401, *range(7410, 7420)]


def shoot():
    gun = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    dice = random.Random(1)
    for number in range(8000):
        head = b'RTPS\x02\x03\x01\x0f' + dice.randbytes(12)
        parts = b''.join(
            bytes([dice.choice((0x06, 0x07, 0x08, 0x09, 0x0E, 0x15, 0x16)), dice.randrange(256)])
            + dice.randbytes(2)
            + dice.randbytes(dice.randrange(64))
            for _ in range(dice.randrange(1, 5))
        )
        try:
            gun.sendto(head + parts, ('127.0.0.1', PORTS[number % len(PORTS)]))
        except OSError:
            pass


threading.Thread(target=shoot, daemon=True).start()
honest.main()
