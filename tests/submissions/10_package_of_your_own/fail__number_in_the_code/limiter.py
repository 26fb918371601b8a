"""Keep the speed of a robot below a limit."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class Limiter(Node):
    """A node that passes on speeds, but not too high ones."""

    def __init__(self):
        """Create the node with its parameter, publisher and subscription."""
        super().__init__('limiter')
        # 1. Declare max_speed. 2. Publish on speed, subscribe to wanted_speed.

        self.declare_parameter('max_speed', 1.0)
        self.publisher = self.create_publisher(Float64, 'speed', 10)
        self.create_subscription(Float64, 'wanted_speed', self.limit, 10)


    def limit(self, wanted):
        """
        Publish the speed that is allowed.

        :param wanted: the Float64 that has arrived [m/s]
        """
        # 3. Read the parameter here, limit both directions, publish.

        most = 1.0
        self.publisher.publish(Float64(data=max(-most, min(wanted.data, most))))



def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    try:
        rclpy.spin(Limiter())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
