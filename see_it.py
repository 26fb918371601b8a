# /// script
# requires-python = ">=3.10,<3.14"
# dependencies = ["ros-jazzy-rclpy[fastrtps]==7.1.6", "ros-jazzy-std-msgs==5.3.6"]
# ///
"""
Show ROS 2 at work with one command and without installation: a talker and a listener.

``uv run see_it.py`` downloads its dependencies (Linux on x86_64) into uv's own cache and leaves no
other files.  The course does not need this program: ``make lab`` prepares everything.
"""

import os

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String

MESSAGES = 3


class Talker(Node):
    """Publishes a greeting twice a second."""

    def __init__(self) -> None:
        super().__init__('talker')
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.5, self.talk)
        self.count = 0

    def talk(self) -> None:
        """Publish the next greeting."""
        self.count += 1
        self.publisher.publish(String(data=f'hello {self.count}'))
        self.get_logger().info(f'publishing: hello {self.count}')


class Listener(Node):
    """Logs each greeting that arrives."""

    def __init__(self) -> None:
        super().__init__('listener')
        self.subscription = self.create_subscription(String, 'chatter', self.hear, 10)
        self.heard = 0

    def hear(self, greeting: String) -> None:
        """Log one greeting."""
        self.heard += 1
        self.get_logger().info(f'heard: {greeting.data}')


def main() -> None:
    """Spin both nodes until the listener has received enough greetings."""
    os.environ.setdefault(
        'ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST'
    )  # messages stay on this machine
    rclpy.init()
    talker, listener = Talker(), Listener()
    executor = SingleThreadedExecutor()
    executor.add_node(talker)
    executor.add_node(listener)
    while listener.heard < MESSAGES:
        executor.spin_once()
    topic = listener.subscription.topic_name
    print(f'{MESSAGES} messages went from one node to another over the topic {topic}.')
    executor.shutdown()
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
