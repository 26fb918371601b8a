from threading import Thread
from time import sleep

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.door = self.create_publisher(String, 'parcels', 10)

    def look(self):
        while not self.door.get_subscription_count():
            sleep(1.0)
        self.door.publish(String(data='for you'))


def main(args=None):
    rclpy.init(args=args)
    node = Courier()
    Thread(target=node.look, daemon=True).start()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
