from dataclasses import dataclass
import math

from rcl_interfaces.msg import SetParametersResult
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


@dataclass(frozen=True)
class Between:
    low: float
    high: float

    def objection(self, value):
        if math.isnan(value):
            return 'NaN is no number'
        if value < self.low or value > self.high:
            return f'from {self.low} to {self.high}, please'
        return None


class Guarded:
    rules = {}

    def guard(self):
        self.add_on_set_parameters_callback(self._guard)

    def _guard(self, parameters):
        objections = [
            self.rules[one.name].objection(one.value)
            for one in parameters if one.name in self.rules
        ]
        first = next(filter(None, objections), '')
        return SetParametersResult(successful=not first, reason=first)


class LimitKeeper(Guarded, Node):
    rules = {'limit_c': Between(-40.0, 125.0)}

    def __init__(self):
        super().__init__('limit_keeper')
        self.guard()
        self.declare_parameter('limit_c', 30.0)
        self.declare_parameter('place', 'motor')
        self.create_subscription(Float64, 'motor_temperature', self.judge, 10)

    def judge(self, message):
        if message.data > self.get_parameter('limit_c').value:
            self.get_logger().warning('warm')


rclpy.init()
rclpy.spin(LimitKeeper())
