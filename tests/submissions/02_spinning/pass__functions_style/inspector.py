import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


def main():
    rclpy.init()
    node = rclpy.create_node('inspector')
    alive = node.create_publisher(Empty, 'alive', 10)
    results = node.create_publisher(String, 'results', 10)

    def look(picture):
        results.publish(String(data=inspect(picture.data)))

    def beat():
        alive.publish(Empty())

    node.create_subscription(String, 'pictures', look, 10)
    node.create_timer(0.5, beat, callback_group=MutuallyExclusiveCallbackGroup())
    rclpy.spin(node, executor=MultiThreadedExecutor(2))


main()
