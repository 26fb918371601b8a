"""The node spins in a thread, the main thread writes the log."""

import queue
import threading

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind, QoSProfile, ReliabilityPolicy
from std_msgs.msg import Float64


class SensorWatch(Node):
    def __init__(self, events):
        super().__init__('sensor_watch')
        profile = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        profile.deadline = Duration(seconds=0.3)
        callbacks = SubscriptionEventCallbacks(
            deadline=lambda e: events.put(('late', e)),
            incompatible_qos=lambda e: events.put(('bad', e)),
        )
        self.create_subscription(
            Float64, 'distance', lambda m: events.put(('distance', m)), profile,
            event_callbacks=callbacks,
        )


def spin(node):
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


def main(args=None):
    rclpy.init(args=args)
    events = queue.Queue()
    node = SensorWatch(events)
    threading.Thread(target=spin, args=(node,), daemon=True).start()
    while rclpy.ok():
        try:
            kind, what = events.get(timeout=0.2)
        except queue.Empty:
            continue
        if kind == 'distance':
            node.get_logger().info(f'{what.data}')
        elif kind == 'late':
            node.get_logger().warning(f'late: {what.total_count}')
        else:
            node.get_logger().error(qos_policy_name_from_kind(what.last_policy_kind))


if __name__ == '__main__':
    main()
