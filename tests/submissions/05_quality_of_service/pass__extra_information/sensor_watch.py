#!/usr/bin/env python3
"""Log distances with the nearest one so far, and say so when the sensor falls silent."""

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64


class SensorWatch(Node):
    """A node that logs distances, silence and refused publishers."""

    def __init__(self):
        """Create the node and its subscription, with callbacks for two events."""
        super().__init__('sensor_watch')
        self.nearest = float('inf')
        profile = QoSProfile(
            depth=5,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            deadline=Duration(seconds=0.3),
        )
        events = SubscriptionEventCallbacks(deadline=self.miss, incompatible_qos=self.refuse)
        self.create_subscription(
            Float64, 'distance', self.hear, profile, event_callbacks=events
        )
        self.get_logger().info('Waiting for distances, a deadline of 0.3 s is requested.')

    def hear(self, message):
        """Log one distance and the nearest."""
        self.nearest = min(self.nearest, message.data)
        self.get_logger().info(f'{message.data} m (nearest so far: {self.nearest} m)')

    def miss(self, event):
        """Log a missed deadline, with what is known."""
        self.get_logger().warning(f'Silence; the nearest was {self.nearest} m')

    def refuse(self, event):
        """Log that a publisher offers too little."""
        policy = qos_policy_name_from_kind(event.last_policy_kind)
        self.get_logger().error(f'{event.total_count} refused, the last for its {policy}')


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = SensorWatch()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
