import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks as Events
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import QoSPolicyKind, qos_profile_sensor_data
from std_msgs.msg import Float64


class SensorWatch(Node):
    def __init__(self):
        super().__init__('sensor_watch')
        self.get_logger().info('ready')
        qos_profile_sensor_data.deadline = Duration(seconds=0.3)
        self.create_subscription(
            Float64,
            'distance',
            lambda m: self.get_logger().info(f'{m.data!r}'),
            qos_profile_sensor_data,
            event_callbacks=Events(
                deadline=lambda e: self.get_logger().warning(f'silence {e.total_count}'),
                incompatible_qos=lambda e: self.get_logger().error(
                    f'incompatible: {QoSPolicyKind(e.last_policy_kind).name}'
                ),
            ),
        )


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
