#!/usr/bin/env python3
"""Hand over one parcel, once somebody is there to take it."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    """A node that publishes once, and only when it can be heard."""

    def __init__(self):
        super().__init__('courier')
        self.publisher = self.create_publisher(String, 'parcels', 10)
        self.pause_s = 0.1
        self.timer = self.create_timer(self.pause_s, self.look_around)

    def look_around(self):
        self.timer.cancel()
        if self.publisher.get_subscription_count() > 0:
            self.publisher.publish(String(data='for you'))
            return
        self.pause_s *= 2  # be polite, do not knock all the time
        self.timer = self.create_timer(self.pause_s, self.look_around)


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = Courier()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
