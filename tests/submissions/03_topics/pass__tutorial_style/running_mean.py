import rclpy
from rclpy.node import Node

from std_msgs.msg import Float64
import math


class MinimalSubscriber(Node):

    def __init__(self):
        super().__init__('running_mean')
        self.subscription = self.create_subscription(
            Float64,
            'readings',
            self.listener_callback,
            10)
        self.subscription  # prevent unused variable warning
        self.publisher_ = self.create_publisher(Float64, 'mean', 10)
        self.values = []
        self.get_logger().info('Running mean has been started')

    def listener_callback(self, msg):
        self.get_logger().info('I heard: "%f"' % msg.data)
        if not math.isnan(msg.data):
            self.values.append(msg.data)
            out = Float64()
            out.data = sum(self.values) / len(self.values)
            self.publisher_.publish(out)


def main(args=None):
    rclpy.init(args=args)
    minimal_subscriber = MinimalSubscriber()
    rclpy.spin(minimal_subscriber)
    minimal_subscriber.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
