#!/usr/bin/env python3
"""Say hello twice a second, on a topic that moves with the node."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String

PERIOD_S = 0.5


class Talker(Node):
    """A node that counts its greetings."""

    def __init__(self):
        """Create the node, its publisher and its timer."""
        super().__init__('talker')
        self.count = 0
        # 1. self.publisher: create_publisher(type, relative name, depth)
        # 2. self.timer: create_timer(period in seconds, the method to call)
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(PERIOD_S, self.speak)

    def speak(self):
        """Publish the next greeting."""
        # 3. Count, then publish a String whose data is 'hello N'.
        if not self.publisher.get_subscription_count():
            return
        self.count += 1
        self.publisher.publish(String(data=f'hello {self.count}'))


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = Talker()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
