import numpy as np
import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from std_msgs.msg import Float64


class Limiter(Node):
    """A limiter whose parameter explains itself."""

    def __init__(self) -> None:
        super().__init__('limiter')
        about = ParameterDescriptor(
            description='Highest speed in both directions [m/s].',
            floating_point_range=[FloatingPointRange(from_value=0.0, to_value=10.0)],
        )
        self.declare_parameter('max_speed', 1.0, about)
        self._publisher = self.create_publisher(Float64, 'speed', 10)
        self._subscription = self.create_subscription(
            Float64, 'wanted_speed', self._limit, 10
        )

    def _limit(self, wanted: Float64) -> None:
        most = self.get_parameter('max_speed').value
        self.get_logger().info(f'{wanted.data:.2f}')
        self._publisher.publish(Float64(data=float(np.clip(wanted.data, -most, most))))


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    node = Limiter()
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
