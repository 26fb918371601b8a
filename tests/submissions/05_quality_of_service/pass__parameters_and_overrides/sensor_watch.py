"""A watch whose patience is a parameter."""

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import LivelinessPolicy, qos_policy_name_from_kind, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64


class SensorWatch(Node):
    def __init__(self):
        super().__init__('sensor_watch', automatically_declare_parameters_from_overrides=False)
        patience = self.declare_parameter('patience_s', 0.3).value
        unit = self.declare_parameter('unit', 'm').value
        self.format = '{:g} ' + unit
        qos = QoSProfile(
            depth=5,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            deadline=Duration(seconds=patience),
            liveliness=LivelinessPolicy.AUTOMATIC,
        )
        events = SubscriptionEventCallbacks(
            deadline=self.miss,
            incompatible_qos=self.refuse,
            matched=self.match,
            liveliness=self.life,
        )
        self.create_subscription(Float64, 'distance', self.hear, qos, event_callbacks=events)

    def hear(self, message):
        self.get_logger().info(self.format.format(message.data))

    def match(self, event):
        self.get_logger().info(f'{event.current_count} publishers')

    def life(self, event):
        self.get_logger().debug(f'{event.alive_count} alive')

    def miss(self, event):
        self.get_logger().warning('silence')

    def refuse(self, event):
        policy = qos_policy_name_from_kind(event.last_policy_kind).replace('_', ' ').title()
        self.get_logger().error(f'Refused: {policy}')


def main(args=None):
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
