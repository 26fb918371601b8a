import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64


def clipped(value):
    return max(-40.0, min(value, 125.0))


class LimitKeeper(Node):

    def __init__(self):
        super().__init__('limit_keeper')
        self.declare_parameter('limit_c', 30.0)
        self.declare_parameter('place', 'motor')
        self.add_on_set_parameters_callback(self.parameter_callback)
        self.subscription = self.create_subscription(
            Float64, 'motor_temperature', self.listener_callback, 10)

    def parameter_callback(self, params):
        for param in params:
            # NaN differs from everything, also from itself
            if param.name == 'limit_c' and not -40.0 < param.value < 125.0:
                self.get_logger().error('limit refused')
                return SetParametersResult(
                    successful=False, reason='limit_c: -40.0 to 125.0 degrees')
        return SetParametersResult(successful=True)

    def listener_callback(self, msg):
        limit_c = self.get_parameter('limit_c').get_parameter_value().double_value
        if msg.data > limit_c:
            self.get_logger().warning('Above the limit: "%s"' % msg.data)


def main(args=None):
    rclpy.init(args=args)
    limit_keeper = LimitKeeper()
    rclpy.spin(limit_keeper)
    limit_keeper.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
