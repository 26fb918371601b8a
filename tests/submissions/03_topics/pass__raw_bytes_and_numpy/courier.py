import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message
from std_msgs.msg import String

PARCEL = serialize_message(String(data='for you'))


class Courier(Node):
    def __init__(self):
        super().__init__('courier')
        self.publisher = self.create_publisher(String, 'parcels', QoSProfile(depth=10))
        self.timer = self.create_timer(0.1, self.look_around)

    def look_around(self):
        if not self.publisher.get_subscription_count():
            return
        self.publisher.publish(PARCEL)
        self.timer.cancel()
        if self.publisher.wait_for_all_acked(Duration(seconds=1)):
            self.get_logger().info('delivered and signed for')


def main(args=None):
    rclpy.init(args=args)
    node = Courier()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
