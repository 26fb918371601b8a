"""Keep the speed of a robot below a limit, which a callback follows."""

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64


class Limiter(Node):
    """A limiter that is told of each new limit."""

    def __init__(self):
        super().__init__('limiter')
        self.most = self.declare_parameter('max_speed', 1.0).value
        self.add_on_set_parameters_callback(self.on_change)
        self.publisher = self.create_publisher(Float64, 'speed', 10)
        self.subscription = self.create_subscription(
            Float64, 'wanted_speed', self.on_speed, 10
        )

    def on_change(self, parameters):
        for parameter in parameters:
            if parameter.name == 'max_speed':
                if parameter.value < 0.0:
                    return SetParametersResult(successful=False, reason='negative')
                self.most = parameter.value
        return SetParametersResult(successful=True)

    def on_speed(self, wanted):
        self.publisher.publish(Float64(data=sorted((-self.most, wanted.data, self.most))[1]))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Limiter())
