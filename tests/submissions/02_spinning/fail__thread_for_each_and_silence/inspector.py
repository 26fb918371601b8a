import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


class Inspector(Node):
    def __init__(self):
        super().__init__('inspector')
        self.alive = self.create_publisher(Empty, 'alive', 10)
        self.results = self.create_publisher(String, 'results', 10)
        self.create_timer(0.5, self.beat)
        self.create_subscription(String, 'pictures', self.take, 10)

    def beat(self):
        self.alive.publish(Empty())

    def take(self, message):
        threading.Thread(target=self.look, args=(message.data,)).start()

    def look(self, picture):
        self.results.publish(String(data=inspect(picture)))


def main(args=None):
    rclpy.init(args=args)
    node = Inspector()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
