#!/usr/bin/env python3
"""A keeper with two callbacks: before and after a change."""

from rcl_interfaces.msg import SetParametersResult
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

LOWEST_C, HIGHEST_C = -40.0, 125.0


class LimitKeeper(Node):

    def __init__(self):
        super().__init__('limit_keeper')
        self.add_on_set_parameters_callback(self.before)
        self.declare_parameter('limit_c', 30.0)
        self.declare_parameter('place', 'motor')
        self.limit_c = self.get_parameter('limit_c').value
        self.add_post_set_parameters_callback(self.after)
        self.create_subscription(Float64, 'motor_temperature', self.judge, 10)

    def before(self, parameters):
        """Refuse what makes no sense, and change nothing."""
        for one in parameters:
            if one.name == 'limit_c':
                sensible = isinstance(one.value, float) and LOWEST_C <= one.value <= HIGHEST_C
                if not sensible:
                    return SetParametersResult(
                        successful=False, reason=f'{one.value} is not from -40.0 to 125.0')
        return SetParametersResult(successful=True)

    def after(self, parameters):
        """Take over what all callbacks have accepted."""
        for one in parameters:
            if one.name == 'limit_c':
                self.limit_c = one.value

    def judge(self, message):
        if message.data > self.limit_c:
            self.get_logger().warning(f'{message.data:.3f} C > {self.limit_c:.3f} C')


def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = LimitKeeper()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
