#!/usr/bin/env python3
"""Warn above a limit that can be changed, and refuse limits that make no sense."""

import math

from rcl_interfaces.msg import SetParametersResult
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64

LOWEST_C, HIGHEST_C = -40.0, 125.0


def why_refused(limit_c):
    """
    Return why a limit makes no sense.

    :param limit_c: any float, including NaN and infinity [degC]
    :returns: the reason, or '' for a limit that makes sense
    """
    if not math.isfinite(limit_c):
        return f'limit_c must be a finite number, not {limit_c}'
    if not LOWEST_C <= limit_c <= HIGHEST_C:
        return f'limit_c must be from {LOWEST_C} to {HIGHEST_C}, not {limit_c}'
    return ''


class LimitKeeper(Node):
    """A monitor whose limit can be changed while it runs."""

    def __init__(self):
        """Create the node, its two parameters and its subscription."""
        super().__init__('limit_keeper')
        self.add_on_set_parameters_callback(self.validate)
        self.declare_parameter('limit_c', 30.0)
        self.declare_parameter('place', 'motor')
        self.create_subscription(Float64, 'motor_temperature', self.judge, 10)

    def validate(self, parameters):
        """Accept or refuse changes, and change nothing."""
        for parameter in parameters:
            if parameter.name == 'limit_c' and (reason := why_refused(parameter.value)):
                return SetParametersResult(successful=False, reason=reason)
        return SetParametersResult(successful=True)

    def judge(self, message):
        """Warn if a temperature is strictly above the limit."""
        limit_c = self.get_parameter('limit_c').value
        if message.data >= limit_c:
            self.get_logger().warning(f'{message.data} degC is above {limit_c} degC')


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
