from math import copysign

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Limiter(Node):
    def __init__(self):
        super().__init__('limiter')
        self.declare_parameters('', [('max_speed', 1.0), ('unused', 'x')])
        self.publisher = self.create_publisher(Float64, 'speed', 10)
        self.create_subscription(Float64, 'wanted_speed', self.limit, 10)

    async def limit(self, wanted):
        most = self.get_parameter('max_speed').value
        size = min(abs(wanted.data), most)
        self.publisher.publish(Float64(data=copysign(size, wanted.data)))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Limiter())


if __name__ == '__main__':
    main()
