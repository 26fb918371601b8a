import copy

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import qos_policy_name_from_kind, QoSPresetProfiles
from std_msgs.msg import Float64


class SensorWatch(Node):

    def __init__(self):
        super().__init__('sensor_watch')
        qos = copy.copy(QoSPresetProfiles.SENSOR_DATA.value)
        qos.deadline = Duration(seconds=3 / 10)
        events = SubscriptionEventCallbacks()
        events.deadline = self.deadline_callback
        events.incompatible_qos = self.incompatible_callback
        self.subscription = self.create_subscription(
            Float64, 'distance', self.listener_callback, qos, event_callbacks=events)
        self.subscription  # prevent unused variable warning

    def listener_callback(self, msg):
        self.get_logger().info('I heard: "%s"' % msg.data)

    def deadline_callback(self, event):
        self.get_logger().warn('Deadline missed!')

    def incompatible_callback(self, event):
        self.get_logger().error('Incompatible QoS: ' +
                                qos_policy_name_from_kind(event.last_policy_kind))


def main(args=None):
    rclpy.init(args=args)
    sensor_watch = SensorWatch()
    rclpy.spin(sensor_watch)
    sensor_watch.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
