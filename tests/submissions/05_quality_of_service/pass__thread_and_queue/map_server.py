"""The node spins in a thread, the main thread publishes."""

import queue
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String


def spin(node):
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('map_server')
    todo = queue.Queue()
    todo.put(String(data='unknown'))
    qos = QoSProfile(
        depth=1,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL,
    )
    pub = node.create_publisher(String, 'map', qos)
    node.create_subscription(String, 'survey', todo.put, 10)
    threading.Thread(target=spin, args=(node,), daemon=True).start()
    while rclpy.ok():
        try:
            pub.publish(todo.get(timeout=0.1))
        except queue.Empty:
            continue


if __name__ == '__main__':
    main()
