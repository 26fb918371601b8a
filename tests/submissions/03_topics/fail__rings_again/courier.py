import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):

    def __init__(self):
        super().__init__('courier')
        self.publisher = self.create_publisher(String, 'parcels', 10)

    def deliver(self):
        while rclpy.ok():
            if self.publisher.get_subscription_count() > 0:
                self.publisher.publish(String(data='for you'))
            time.sleep(0.5)


def main(args=None):
    rclpy.init(args=args)
    node = Courier()
    threading.Thread(target=node.deliver, daemon=True).start()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
