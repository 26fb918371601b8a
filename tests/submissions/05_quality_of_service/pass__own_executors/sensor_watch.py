import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    qos_policy_name_from_kind,
    QoSProfile,
    ReliabilityPolicy,
)
from std_msgs.msg import Float64


class Watch(Node):
    def __init__(self):
        super().__init__('sensor_watch')
        self.misses = 0
        qos = QoSProfile(
            history=HistoryPolicy.KEEP_ALL,
            reliability=ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.VOLATILE,
            deadline=Duration(seconds=0, nanoseconds=300000000),
        )
        events = SubscriptionEventCallbacks(use_default_callbacks=False)
        events.deadline = self.on_deadline
        events.incompatible_qos = self.on_refusal
        self.create_subscription(
            Float64,
            'distance',
            self.on_distance,
            qos,
            callback_group=ReentrantCallbackGroup(),
            event_callbacks=events,
        )

    async def on_distance(self, msg):
        self.get_logger().info('Distance: ' + str(msg.data))

    def on_deadline(self, info):
        self.misses += info.total_count_change
        self.get_logger().warning('Missed %d deadlines' % self.misses)

    def on_refusal(self, info):
        name = qos_policy_name_from_kind(info.last_policy_kind).lower()
        self.get_logger().error('refused because of its ' + name)


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Watch())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
