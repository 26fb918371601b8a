import threading
import time

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


class Heart(Node):
    def __init__(self):
        super().__init__('heart')
        self.alive = self.create_publisher(Empty, 'alive', 10)
        self.create_timer(0.5, self.beat)

    def beat(self):
        self.alive.publish(Empty())


class Inspector(Node):
    def __init__(self):
        super().__init__('inspector')
        self.results = self.create_publisher(String, 'results', 10)
        self.create_subscription(String, 'pictures', self.look, 10)

    def look(self, message):
        self.results.publish(String(data=inspect(message.data)))


def main(args=None):
    rclpy.init(args=args)
    heart = SingleThreadedExecutor()
    heart.add_node(Heart())
    threading.Thread(target=heart.spin, daemon=True).start()
    rclpy.spin(Inspector())


if __name__ == '__main__':
    main()
