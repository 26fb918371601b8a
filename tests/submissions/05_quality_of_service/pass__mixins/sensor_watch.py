"""Events in a mixin, distances in the node."""

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64


class EventLogMixin:
    """Turns events of a subscription into lines of the log."""

    @property
    def event_callbacks(self):
        return SubscriptionEventCallbacks(
            deadline=self.on_deadline, incompatible_qos=self.on_incompatible_qos
        )

    def on_deadline(self, info):
        self.get_logger().warning('deadline missed')

    def on_incompatible_qos(self, info):
        self.get_logger().error(self.describe(info))

    @staticmethod
    def describe(info):
        return 'incompatible: ' + qos_policy_name_from_kind(info.last_policy_kind)


class SensorProfile(QoSProfile):
    def __init__(self, deadline_s):
        super().__init__(
            depth=5,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            deadline=Duration(seconds=deadline_s),
        )


class SensorWatch(EventLogMixin, Node):
    def __init__(self):
        super().__init__('sensor_watch')
        self.create_subscription(
            Float64,
            'distance',
            self.on_distance,
            SensorProfile(0.3),
            event_callbacks=self.event_callbacks,
        )

    def on_distance(self, message):
        self.get_logger().info('%s' % message)


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(SensorWatch())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
