import copy

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, qos_profile_system_default, ReliabilityPolicy
from std_msgs.msg import String


class MapServer(Node):

    def __init__(self):
        super().__init__('map_server')
        qos = copy.copy(qos_profile_system_default)
        qos.depth = 1
        qos.reliability = ReliabilityPolicy.RELIABLE
        qos.durability = DurabilityPolicy.TRANSIENT_LOCAL
        self.publisher_ = self.create_publisher(String, 'map', qos)
        self.subscription = self.create_subscription(String, 'survey', self.listener_callback, 10)
        self.subscription  # prevent unused variable warning
        msg = String()
        msg.data = 'unknown'
        self.publisher_.publish(msg)

    def listener_callback(self, msg):
        out = String()
        out.data = msg.data
        self.publisher_.publish(out)
        self.get_logger().info('Publishing: "%s"' % out.data)


def main(args=None):
    rclpy.init(args=args)
    map_server = MapServer()
    rclpy.spin(map_server)
    map_server.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
