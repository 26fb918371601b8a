import math

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSPresetProfiles, qos_policy_name_from_kind
from std_msgs.msg import Float64


def make():
    node = rclpy.create_node('sensor_watch')
    log = node.get_logger()
    qos = QoSPresetProfiles.get_from_short_key('sensor_data')
    qos.deadline = Duration(nanoseconds=300_000_000)

    def hear(message):
        if math.isinf(message.data):
            return
        log.info('distance %.2f' % message.data)

    def late(event):
        log.warning('too late')

    def refused(event):
        log.error(qos_policy_name_from_kind(event.last_policy_kind))

    node.create_subscription(
        Float64,
        'distance',
        hear,
        qos,
        event_callbacks=SubscriptionEventCallbacks(deadline=late, incompatible_qos=refused),
    )
    return node


def main(args=None):
    rclpy.init(args=args)
    node = make()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
