"""
Tries: publish in every likely namespace instead of its own.

Stopped by: the namespace is drawn from a secret; other names earn nothing
Deserves: 7 at most
"""

import rclpy
from std_msgs.msg import String

SPACES = ('', '/lab', '/north', '/student', '/grader', '/test', '/ns', '/robot', '/a', '/b')
rclpy.init()
node = rclpy.create_node('talker', namespace='/lab')
publishers = [node.create_publisher(String, f'{space}/chatter', 10) for space in SPACES]
count = 0


def tick():
    global count
    count += 1
    for publisher in publishers:
        publisher.publish(String(data=f'hello {count}'))


node.create_timer(0.5, tick)
rclpy.spin(node)
