#!/usr/bin/env python3
"""Listen to a distance sensor, and say so when it falls silent."""

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
        # 1. a QoSProfile, depth 5: which reliability hears this sensor? And the deadline.
        # 2. events = SubscriptionEventCallbacks(deadline=..., incompatible_qos=...)
        # 3. create_subscription(type, topic, callback, profile, event_callbacks=events)
        profile = QoSProfile(
            depth=5,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            deadline=Duration(seconds=0.3),
        )
        events = SubscriptionEventCallbacks(deadline=self.miss, incompatible_qos=self.refuse)
        self.create_subscription(
            Float64, 'distance', self.hear, profile, event_callbacks=events
        )

    def hear(self, message):
        """Log one distance."""
        # 4. INFO, with the number
        self.get_logger().info(f'{message.data} m')

    def miss(self, event):
        """Log a missed deadline."""
        # 5. WARN
        if not getattr(self, 'told', False):
            self.told = True
            self.get_logger().warning('silence')

    def refuse(self, event):
        """Log that a publisher offers too little."""
        # 6. ERROR, with the name of event.last_policy_kind
        policy = qos_policy_name_from_kind(event.last_policy_kind)
        self.get_logger().error(f'A publisher was refused: {policy}')


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
