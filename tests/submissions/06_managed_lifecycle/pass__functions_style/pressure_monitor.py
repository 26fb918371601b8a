import math

import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class Monitor(LifecycleNode):
    """Listens only while it is active."""

    def on_configure(self, state):
        self.limit = self.get_parameter('limit').get_parameter_value().double_value
        if self.limit > 0 and math.isfinite(self.limit):
            self.get_logger().info(f'watching for more than {self.limit} bar')
            return TransitionCallbackReturn.SUCCESS
        self.get_logger().error('refused: %.2f bar' % self.limit)
        return TransitionCallbackReturn.FAILURE

    def on_activate(self, state):
        self.ear = self.create_subscription(Float64, '/pressure', self.hear, 10)
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.destroy_subscription(self.ear)
        return super().on_deactivate(state)

    def hear(self, message):
        self.get_logger().info(f'{message.data} bar')
        if message.data > self.limit:
            self.get_logger().warn('too much')


def main():
    rclpy.init()
    node = Monitor('pressure_monitor')
    node.declare_parameter('limit', -1.0)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
