"""
Send back on ``/echo_out`` whatever arrives on ``/echo_in``, in the message type just built.

Usage: echo_node.py PACKAGE/msg/TYPE.  The probe holds the reference type on the other end, so an
answer with the same values proves that the built type is the right one, on the wire.
"""

from __future__ import annotations

import importlib
import sys

import rclpy
from rclpy.node import Node


def main() -> None:
    """Echo until the sandbox is ended."""
    package, kind, name = sys.argv[1].split('/')
    message_type = getattr(importlib.import_module(f'{package}.{kind}'), name)
    rclpy.init(args=[])
    node = Node('built_message_echo')
    publisher = node.create_publisher(message_type, '/echo_out', 10)
    node.create_subscription(message_type, '/echo_in', publisher.publish, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
