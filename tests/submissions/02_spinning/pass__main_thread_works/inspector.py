import queue
import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


def main():
    rclpy.init()
    node = Node('inspector')
    alive = node.create_publisher(Empty, 'alive', 10)
    results = node.create_publisher(String, 'results', 10)
    pictures = queue.SimpleQueue()
    node.create_timer(0.5, lambda: alive.publish(Empty()))
    node.create_subscription(String, 'pictures', pictures.put, 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    while rclpy.ok():
        results.publish(String(data=inspect(pictures.get().data)))


if __name__ == '__main__':
    main()
