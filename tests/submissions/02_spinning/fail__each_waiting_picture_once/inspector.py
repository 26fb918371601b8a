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
        self.todo = []
        self.changed = threading.Condition()
        self.results = self.create_publisher(String, 'results', 10)
        self.alive = self.create_publisher(Empty, 'alive', 10)
        self.create_subscription(String, 'pictures', self.take, 10)
        self.create_timer(0.5, lambda: self.alive.publish(Empty()))
        threading.Thread(target=self.work, daemon=True).start()

    def take(self, message):
        with self.changed:
            if message.data not in self.todo:
                self.todo.append(message.data)
                self.changed.notify()

    def work(self):
        while True:
            with self.changed:
                self.changed.wait_for(lambda: self.todo)
                picture = self.todo.pop(0)
            self.results.publish(String(data=inspect(picture)))


def main():
    rclpy.init()
    rclpy.spin(Inspector())


if __name__ == '__main__':
    main()
