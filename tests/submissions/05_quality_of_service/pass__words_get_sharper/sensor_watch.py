import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import QoSPolicyKind, QoSProfile
from std_msgs.msg import Float64


class SensorWatch(Node):
    def __init__(self):
        super().__init__('sensor_watch')
        qos = QoSProfile(depth=1, reliability=2, deadline=Duration(seconds=0, nanoseconds=300000000))
        self.misses = 0
        self.sub = self.create_subscription(
            Float64, 'distance', self.hear, qos,
            event_callbacks=SubscriptionEventCallbacks(deadline=self.miss, incompatible_qos=self.no))

    def hear(self, msg):
        if self.misses:
            self.get_logger().info(f'back again: {msg.data}')
            self.misses = 0
        else:
            self.get_logger().info(f'{msg.data}')

    def miss(self, info):
        self.misses += 1
        if self.misses == 1:
            self.get_logger().warning('The sensor is late')
        elif self.misses < 4:
            self.get_logger().warning('The sensor is silent')
        else:
            self.get_logger().warning('Is the sensor dead?')

    def no(self, info):
        self.get_logger().error(f'Refused: {QoSPolicyKind(info.last_policy_kind).name}')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(SensorWatch())


if __name__ == '__main__':
    main()
