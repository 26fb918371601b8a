import threading
import time

import rclpy
from std_msgs.msg import String


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('courier')
    publisher = node.create_publisher(String, 'parcels', 10)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
    time.sleep(2.0)  # discovery
    publisher.publish(String(data='for you'))
    while rclpy.ok():
        time.sleep(0.1)


if __name__ == '__main__':
    main()
