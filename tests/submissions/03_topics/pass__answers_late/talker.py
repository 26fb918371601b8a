import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):

    def __init__(self):
        super().__init__('talker')
        self.stopped = threading.Event()
        self.publisher = self.create_publisher(String, 'chatter', 10)
        threading.Thread(target=self.speak, daemon=True).start()

    def speak(self):
        count = 0
        while not self.stopped.wait(0.5):
            count += 1
            self.publisher.publish(String(data=f'hello {count}'))


def main(args=None):
    rclpy.init(args=args)
    node = Talker()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.stopped.set()


if __name__ == '__main__':
    main()
