"""A watch from functions."""

from contextlib import suppress
from functools import partial

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.qos import qos_policy_name_from_kind, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64


def tell_distance(log, message):
    log.info('Distance {} m'.format(message.data))


def tell_silence(log, missed):
    log.warning('Nothing for 0.3 s')


def tell_refusal(log, refused):
    log.error(f'{qos_policy_name_from_kind(refused.last_policy_kind)} is too weak')


def create_sensor_watch():
    node = rclpy.create_node('sensor_watch')
    log = node.get_logger()
    node.create_subscription(
        Float64,
        'distance',
        partial(tell_distance, log),
        QoSProfile(
            depth=5,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            deadline=Duration(nanoseconds=int(0.3e9)),
        ),
        event_callbacks=SubscriptionEventCallbacks(
            deadline=partial(tell_silence, log),
            incompatible_qos=partial(tell_refusal, log),
        ),
    )
    return node


def main(args=None):
    rclpy.init(args=args)
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(create_sensor_watch())


if __name__ == '__main__':
    main()
