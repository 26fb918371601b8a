#!/usr/bin/env python3
"""Hand over one parcel, once somebody is there to take it."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String

LOOK_AROUND_S = 0.1


class Courier(Node):
    """A node that publishes once, and only when it can be heard."""

    def __init__(self):
        """Create the node, its publisher, and what notices a listener."""
        super().__init__('courier')
        self.delivered = False
        # 1. self.publisher on 'parcels'.
        # 2. self.timer, every LOOK_AROUND_S seconds, calls self.look_around.
        self.publisher = self.create_publisher(String, 'parcels', 10)
        self.timer = self.create_timer(LOOK_AROUND_S, self.look_around)

    def look_around(self):
        """Deliver if somebody is connected, and if it was not done before."""
        # 3. get_subscription_count() tells who is connected.
        # 4. Publish 'for you' and remember that; self.timer.cancel() ends the search.
        if not self.delivered and self.publisher.get_subscription_count() > 0:
            self.delivered = True
            self.publisher.publish(String(data='for you'))
            self.timer.cancel()


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = Courier()
    node.spin()


if __name__ == '__main__':
    main()
