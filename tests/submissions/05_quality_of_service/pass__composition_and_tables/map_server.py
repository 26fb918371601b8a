"""The server has a node, it is none."""

from dataclasses import dataclass, field

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

QOS = {
    'history': HistoryPolicy.get_from_short_key('keep_last'),
    'depth': 1,
    'reliability': ReliabilityPolicy.get_from_short_key('reliable'),
    'durability': DurabilityPolicy.get_from_short_key('transient_local'),
}


@dataclass
class MapServer:
    name: str = 'map_server'
    newest: str = 'unknown'
    node: Node = field(init=False)

    def __post_init__(self):
        self.node = Node(self.name)
        self.out = self.node.create_publisher(String, 'map', QoSProfile(**QOS))
        self.node.create_subscription(String, 'survey', self, 10)
        self(String(data=self.newest))

    def __call__(self, survey):
        self.newest = survey.data
        self.out.publish(String(data=self.newest))


def main(args=None):
    rclpy.init(args=args)
    server = MapServer()
    try:
        rclpy.spin(server.node)
    except (KeyboardInterrupt, ExternalShutdownException):
        server.node.destroy_node()
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
