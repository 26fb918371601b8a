"""
Tries: announce, in the name of the probe's own participant, that it has no nodes.

Stopped by: a participant ignores announcements about itself; the probe identifies endpoints by id
Deserves: 15
"""

import threading
import time

import honest
import participants
import rclpy

rclpy.init()
node = honest.TemperaturePublisher()
send = participants.channel(node)


def erase():
    for _ in range(200):
        for info in node.get_publishers_info_by_topic('/clock'):
            send(bytes(info.endpoint_gid[:12]), [])
        time.sleep(0.005)


threading.Thread(target=erase, daemon=True).start()
rclpy.spin(node)
