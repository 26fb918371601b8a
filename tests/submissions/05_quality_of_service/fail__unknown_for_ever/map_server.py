import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class MapServer(Node):

    def __init__(self):
        super().__init__('map_server')
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'map', latched)
        self.create_subscription(String, 'survey', self.publisher.publish, 10)
        self.first()
        self.create_timer(1.0, self.first)

    def first(self):
        self.publisher.publish(String(data='unknown'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(MapServer())


if __name__ == '__main__':
    main()
