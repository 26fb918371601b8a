import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.pub = self.create_publisher(String, 'parcels', 10)
        self.timer = self.create_timer(0.2, self.tick)

    def tick(self):
        if self.pub.get_subscription_count() > 0:
            time.sleep(3)
            self.pub.publish(String(data='for you'))
            self.timer.cancel()


rclpy.init()
rclpy.spin(Courier())
