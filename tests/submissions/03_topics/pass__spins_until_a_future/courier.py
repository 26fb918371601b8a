import rclpy
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.someone = Future()
        self.pub = self.create_publisher(String, 'parcels', 10)
        self.t = self.create_timer(0.2, lambda: self.pub.get_subscription_count() and not self.someone.done() and self.someone.set_result(True))


def main(args=None):
    rclpy.init(args=args)
    node = Courier()
    rclpy.spin_until_future_complete(node, node.someone)
    node.destroy_timer(node.t)
    node.pub.publish(String(data='for you'))
    rclpy.spin(node)


if __name__ == '__main__':
    main()
