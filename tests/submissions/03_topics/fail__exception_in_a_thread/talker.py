import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.publisher = self.create_publisher(String, 'chatter', 10)
        self.timer = self.create_timer(0.5, self.speak)

    def speak(self):
        self.count += 1
        message = String()
        message.data = 'hello ' + self.count
        self.publisher.publish(message)


def main(args=None):
    rclpy.init(args=args)
    node = Talker()
    spinner = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    spinner.start()
    while rclpy.ok():
        time.sleep(1)


if __name__ == '__main__':
    main()
