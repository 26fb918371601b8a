"""
Tries: make the probe compute for minutes with one RTPS HEARTBEAT of 2^40 messages.

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
# DDSI-RTPS 2.3, 8.3.7.5 and 9.4.5.7: the first and the last message that there are, and a counter.
first, last, counter = (1 << 8, 0), (1 << 8, 0), 1000
beat = anybody + writer + struct.pack("<iIiII", *first, *last, counter)
packet = b'RTPS\x02\x03\x01\x0f' + prefix + b'\x07\x01' + struct.pack('<H', len(beat)) + beat


def send():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as gun:
        for port in range(7410, 7420):
            gun.sendto(packet, ('127.0.0.1', port))


node.create_timer(3.0, send)
rclpy.spin(node)
