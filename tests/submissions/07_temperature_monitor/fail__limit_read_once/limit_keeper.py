import math

from rcl_interfaces.msg import SetParametersResult
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class LimitKeeper(Node):
    def __init__(self):
        super().__init__('limit_keeper')
        self.declare_parameters('', [('limit_c', 30.0), ('place', 'motor')])
        self.limit_c = self.get_parameter('limit_c').value
        self.add_on_set_parameters_callback(self.validate)
        self.create_subscription(Float64, 'motor_temperature', self.judge, 10)

    def validate(self, parameters):
        wanted = [one.value for one in parameters if one.name == 'limit_c']
        if all(math.isfinite(one) and -40.0 <= one <= 125.0 for one in wanted):
            return SetParametersResult(successful=True)
        return SetParametersResult(successful=False, reason='expected -40.0 to 125.0 degC')

    def store(self, parameters):
        for one in parameters:
            if one.name == 'limit_c':
                self.limit_c = one.value

    def judge(self, message):
        if message.data > self.limit_c:
            self.get_logger().warning(f'{message.data:.2f} > {self.limit_c:.2f}')


def main():
    rclpy.init()
    rclpy.spin(LimitKeeper())


main()
