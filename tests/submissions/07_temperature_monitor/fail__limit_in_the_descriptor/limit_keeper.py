import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from std_msgs.msg import Float64


class LimitKeeper(Node):
    def __init__(self):
        super().__init__('limit_keeper')
        sensible = FloatingPointRange(from_value=-40.0, to_value=125.0)
        self.declare_parameter(
            'limit_c', 30.0,
            ParameterDescriptor(description='limit [degC]', floating_point_range=[sensible]))
        self.declare_parameter('place', 'motor')
        self.create_subscription(Float64, 'motor_temperature', self.judge, 10)

    def judge(self, message):
        if message.data > self.get_parameter('limit_c').value:
            self.get_logger().warning(f'{message.data} is too warm')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(LimitKeeper())


if __name__ == '__main__':
    main()
