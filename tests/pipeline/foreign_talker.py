"""
Publish on all topics of an exercise, in every given ROS domain.

Usage: foreign_talker.py DOMAIN...  Prints ``talking`` when it has started, and continues until
its standard input ends.
"""

import select
import sys

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Int32, String


def main() -> None:
    publishers = []
    for domain in map(int, sys.argv[1:]):
        context = Context()
        rclpy.init(args=[], context=context, domain_id=domain)
        node = Node(
            'talker',
            context=context,
            start_parameter_services=False,
            enable_rosout=False,
            use_global_arguments=False,
        )
        publishers.append((node.create_publisher(String, '/chatter', 10), String(data='foreign')))
        publishers.append((node.create_publisher(Int32, '/number', 10), Int32(data=-1)))
        publishers.append((node.create_publisher(Clock, '/clock', 10), Clock()))
        SingleThreadedExecutor(context=context).add_node(node)
    said = False
    while not select.select([sys.stdin], [], [], 0.2)[0]:
        for publisher, message in publishers:
            publisher.publish(message)
        if not said:
            said = True
            print('talking', flush=True)


if __name__ == '__main__':
    main()
