"""
Tries: send texts with terminal codes, markup, half surrogates and a hundred thousand characters.

Stopped by: the probe records only the size of long messages; feedback escapes and shortens strings
Deserves: 9 at most
Flag: too large
"""

import rclpy
from std_msgs.msg import String

TEXTS = (
    '<b onmouseover=alert(1)>',
    '\x1b[2J\x00',
    '=1+1',
    'x' * 100_000,
    '\u202eevil',
    '{{ 7 * 7 }}',
)
rclpy.init()
node = rclpy.create_node('talker')
publisher = node.create_publisher(String, 'chatter', 10)
count = 0


def tick():
    global count
    count += 1
    publisher.publish(String(data=TEXTS[count % len(TEXTS)]))


node.create_timer(0.5, tick)
rclpy.spin(node)
