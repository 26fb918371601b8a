import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


def main(args=None):
    rclpy.init(args=args)
    node = Node('talker')
    publisher = node.create_publisher(String, 'chatter', 10)
    count = 0
    while rclpy.ok():
        count += 1
        publisher.publish(String(data=f'hello {count}'))
        time.sleep(0.5)


if __name__ == '__main__':
    main()
