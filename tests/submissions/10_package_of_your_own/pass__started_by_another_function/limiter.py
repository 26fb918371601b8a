import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

NAME = 'limiter'
PARAMETER = 'max_speed'


class Limiter(Node):
    def __init__(self, **options):
        super().__init__(NAME, **options)
        self.declare_parameter(PARAMETER, 1.0)
        speeds = self.create_publisher(Float64, 'speed', 10)
        self.create_subscription(
            Float64, 'wanted_speed', lambda one: speeds.publish(self.limited(one)), 10
        )

    def limited(self, one):
        most = self.get_parameter(PARAMETER).value
        return Float64(data=min(most, max(-most, one.data)))


def start_node():
    rclpy.init()
    node = Limiter()
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        node.get_logger().info('stopped')


def main(args=None):
    start_node()
