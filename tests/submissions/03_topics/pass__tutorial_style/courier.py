import rclpy
from rclpy.node import Node

from std_msgs.msg import String


class MinimalCourier(Node):

    def __init__(self):
        super().__init__('courier')
        self.publisher_ = self.create_publisher(String, 'parcels', 10)
        timer_period = 1.0  # seconds
        self.timer = self.create_timer(timer_period, self.timer_callback)
        self.sent = False
        self.get_logger().info('Courier has been started')

    def timer_callback(self):
        if self.sent:
            return
        if self.publisher_.get_subscription_count() == 0:
            self.get_logger().info('Nobody there, waiting...')
            return
        msg = String()
        msg.data = 'for you'
        self.publisher_.publish(msg)
        self.sent = True
        self.get_logger().info('Delivered: "%s"' % msg.data)


def main(args=None):
    rclpy.init(args=args)
    minimal_courier = MinimalCourier()
    rclpy.spin(minimal_courier)
    minimal_courier.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
