import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import Float64


def limited(speed, most):
    """Return a speed within the limit, forwards and backwards."""
    return max(-most, min(speed, most))


class Limiter:
    """Has a node, and is none."""

    def __init__(self, node):
        self.node = node
        self.most = node.declare_parameter('max_speed', 1.0)
        self.publisher = node.create_publisher(Float64, 'speed', 10)
        node.create_subscription(Float64, 'wanted_speed', self, 10)

    def __call__(self, wanted):
        most = self.node.get_parameter('max_speed').value
        self.publisher.publish(Float64(data=limited(wanted.data, most)))


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('limiter')
    limiter = Limiter(node)
    executor = SingleThreadedExecutor()
    executor.add_node(limiter.node)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
