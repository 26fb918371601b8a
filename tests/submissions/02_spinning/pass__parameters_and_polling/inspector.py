import queue
import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


class Inspector(Node):
    """Only the main thread publishes; a worker inspects."""

    def __init__(self):
        super().__init__('inspector')
        self.declare_parameter('beat_s', 0.5)
        self.todo, self.done = queue.Queue(), queue.Queue()
        self.alive = self.create_publisher(Empty, 'alive', 10)
        self.results = self.create_publisher(String, 'results', 10)
        self.create_subscription(String, 'pictures', lambda m: self.todo.put(m.data), 10)
        self.create_timer(self.get_parameter('beat_s').value, self.beat)
        self.create_timer(0.05, self.deliver)
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while True:
            self.done.put(inspect(self.todo.get()))

    def beat(self):
        self.alive.publish(Empty())

    def deliver(self):
        while not self.done.empty():
            self.results.publish(String(data=self.done.get()))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Inspector())


if __name__ == '__main__':
    main()
