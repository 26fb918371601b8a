from __future__ import annotations

from collections.abc import Sequence
import math

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Float64


class LimitKeeper(Node):
    """Watches a motor, with a limit that is checked by itself."""

    def __init__(self) -> None:
        super().__init__('limit_keeper')
        self.declare_parameter('limit_c', 30.0, ParameterDescriptor(dynamic_typing=True))
        self.declare_parameter('place', 'motor')
        self.add_on_set_parameters_callback(self._validate)
        self.create_subscription(Float64, 'motor_temperature', self._judge, 10)

    def _validate(self, parameters: Sequence[Parameter]) -> SetParametersResult:
        for one in parameters:
            if one.name != 'limit_c':
                continue
            if one.type_ is not Parameter.Type.DOUBLE:
                return SetParametersResult(successful=False, reason=f'{one.type_} is no float')
            if not math.isfinite(one.value) or abs(one.value - 42.5) > 82.5:
                return SetParametersResult(successful=False, reason=f'{one.value} makes no sense')
        return SetParametersResult(successful=True)

    def _judge(self, message: Float64) -> None:
        limit: float = self.get_parameter('limit_c').value
        if message.data > limit:
            self.get_logger().warning(f'{message.data} > {limit}')


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    rclpy.spin(LimitKeeper())


if __name__ == '__main__':
    main()
