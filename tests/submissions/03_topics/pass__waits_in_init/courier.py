import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        publisher = self.create_publisher(String, 'parcels', 10)
        while publisher.get_subscription_count() == 0:
            time.sleep(0.05)
        publisher.publish(String(data='for you'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Courier())


if __name__ == '__main__':
    main()
