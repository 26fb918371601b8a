"""
Send back on ``/echo_out`` every message from ``/echo_in``, in the type that was just built.

Usage: echo_node.py PACKAGE/msg/TYPE.  The probe uses the reference type, so an answer with the
same values shows that the built type is correct.
"""

from __future__ import annotations

import importlib
import sys

import rclpy
from rclpy.node import Node


def main() -> None:
    """Echo messages until the sandbox ends."""
    package, kind, name = sys.argv[1].split('/')
    message_type = getattr(importlib.import_module(f'{package}.{kind}'), name)
    rclpy.init(args=[])
    node = Node('built_message_echo')
    publisher = node.create_publisher(message_type, '/echo_out', 10)
    node.create_subscription(message_type, '/echo_in', publisher.publish, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
