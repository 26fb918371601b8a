from queue import Empty as NothingCame, Queue
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
        self.todo = Queue()
        self.results = self.create_publisher(String, 'results', 10)
        self.alive = self.create_publisher(Empty, 'alive', 10)
        self.create_subscription(String, 'pictures', self.todo.put, 10)
        self.create_timer(0.5, lambda: self.alive.publish(Empty()))
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while True:
            try:
                picture = self.todo.get(timeout=8.0).data
            except NothingCame:
                return
            self.results.publish(String(data=inspect(picture)))


def main():
    rclpy.init()
    rclpy.spin(Inspector())


if __name__ == '__main__':
    main()
