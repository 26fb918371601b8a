"""
Republish every message from ``/echo_in`` on ``/echo_out``, with the message type just built.

Usage: echo_node.py PACKAGE/msg/TYPE.  The probe uses the course's own build of the type, so an
echo with the same values shows that the student's type is correct.
"""

import importlib
import sys

import rclpy
from rclpy.node import Node


def main() -> None:
    """Echo messages until the sandbox is stopped."""
    package, kind, name = sys.argv[1].split('/')
    message_type = getattr(importlib.import_module(f'{package}.{kind}'), name)
    rclpy.init(args=[])
    node = Node('built_message_echo')
    publisher = node.create_publisher(message_type, '/echo_out', 10)
    node.create_subscription(message_type, '/echo_in', publisher.publish, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
