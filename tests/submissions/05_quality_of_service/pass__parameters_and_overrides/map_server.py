"""A map server that can be adapted without touching its code."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions
from std_msgs.msg import String


class MapServer(Node):
    def __init__(self, **kwargs):
        super().__init__('map_server', **kwargs)
        self.declare_parameter('first_map', 'unknown')
        self.declare_parameter('depth', 10)
        self.maps = self.create_publisher(
            String,
            'map',
            QoSProfile(
                depth=1,
                reliability=ReliabilityPolicy.RELIABLE,
                durability=DurabilityPolicy.TRANSIENT_LOCAL,
            ),
            qos_overriding_options=QoSOverridingOptions([QoSPolicyKind.DEPTH]),
        )
        self.surveys = self.create_subscription(
            String, 'survey', self.maps.publish, self.get_parameter('depth').value
        )
        first = self.get_parameter('first_map').get_parameter_value().string_value
        self.maps.publish(String(data=first))


def main(args=None):
    rclpy.init(args=args)
    node = MapServer()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
