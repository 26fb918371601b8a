"""Keep the speed of a robot below a limit, without a class."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Float64


def main():
    """Run the node until it is interrupted or terminated."""
    rclpy.init()
    node = rclpy.create_node('limiter')
    node.declare_parameter('max_speed', 1.0)
    publisher = node.create_publisher(Float64, 'speed', 10)

    def limit(wanted):
        most = node.get_parameter('max_speed').get_parameter_value().double_value
        if wanted.data > most:
            wanted.data = most
        elif wanted.data < -most:
            wanted.data = -most
        publisher.publish(wanted)

    node.create_subscription(Float64, 'wanted_speed', limit, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
