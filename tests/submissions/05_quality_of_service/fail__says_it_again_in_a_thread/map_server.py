import threading
import time

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class MapServer(Node):

    def __init__(self):
        super().__init__('map_server')
        profile = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.publisher = self.create_publisher(String, 'map', profile)
        self.create_subscription(String, 'survey', self.survey, 10)
        self.newest = None
        self.publisher.publish(String(data='unknown'))

    def survey(self, message):
        self.newest = message
        self.publisher.publish(message)

    def remind(self):
        while rclpy.ok():
            time.sleep(0.5)
            if self.newest:
                self.publisher.publish(self.newest)


def main(args=None):
    rclpy.init(args=args)
    server = MapServer()
    threading.Thread(target=server.remind, daemon=True).start()
    rclpy.spin(server)


if __name__ == '__main__':
    main()
