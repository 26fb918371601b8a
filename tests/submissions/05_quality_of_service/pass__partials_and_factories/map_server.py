"""A map server from functions."""

from contextlib import suppress
from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


def latched(depth=1):
    return QoSProfile(depth=depth, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def draw(publisher, survey):
    publisher.publish(String(data=survey.data))


def create_map_server():
    node = rclpy.create_node('map_server')
    publisher = node.create_publisher(String, 'map', latched())
    node.create_subscription(String, 'survey', partial(draw, publisher), 10)
    draw(publisher, String(data='unknown'))
    return node


def main(args=None):
    rclpy.init(args=args)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(create_map_server())


if __name__ == '__main__':
    main()
