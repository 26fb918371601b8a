"""A watch that has a node, with what it says in a table."""

from builtin_interfaces.msg import Duration as DurationMsg
import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSPolicyKind, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64

TEXTS = {
    'distance': 'The next obstacle is at %.3f m.',
    'silence': 'No reading for the %d. time.',
    'refused': 'A sensor is not good enough: %s.',
}


class SensorWatch:
    def __init__(self, node):
        self.log = node.get_logger().get_child('events')
        self.plain = node.get_logger()
        profile = QoSProfile(
            depth=5,
            reliability=ReliabilityPolicy.get_from_short_key('best_effort'),
            deadline=Duration.from_msg(DurationMsg(sec=0, nanosec=300_000_000)),
        )
        node.create_subscription(
            Float64,
            'distance',
            self.on_distance,
            profile,
            event_callbacks=SubscriptionEventCallbacks(
                deadline=self.on_silence, incompatible_qos=self.on_refused
            ),
        )

    def on_distance(self, message):
        self.plain.info(TEXTS['distance'] % message.data)

    def on_silence(self, event):
        self.log.warning(TEXTS['silence'] % event.total_count)

    def on_refused(self, event):
        kind = QoSPolicyKind(event.last_policy_kind)
        self.log.error(TEXTS['refused'] % kind.name.capitalize())


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('sensor_watch')
    watch = SensorWatch(node)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        watch.plain.debug('good bye')
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
