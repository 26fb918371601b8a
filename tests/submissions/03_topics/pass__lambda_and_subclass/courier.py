import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.pub = self.create_publisher(String, 'parcels', 10)
        self.tmr = self.create_timer(0.5, lambda: self.pub.get_subscription_count() and self.deliver())

    def deliver(self):
        self.pub.publish(String(data='for you'))
        self.destroy_timer(self.tmr)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Courier())
