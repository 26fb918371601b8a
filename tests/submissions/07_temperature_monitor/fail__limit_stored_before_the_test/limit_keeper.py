from math import inf, nan
import rclpy
from rclpy.node import Node
from rcl_interfaces.msg import SetParametersResult
from std_msgs.msg import Float64


class LimitKeeper(Node):
    limit = 30.0

    def __init__(self):
        super().__init__('limit_keeper')
        self.limit = self.declare_parameter('limit_c', self.limit).value
        self.place = self.declare_parameter('place', 'motor').value
        self.add_on_set_parameters_callback(self.on_set)
        self.create_subscription(Float64, 'motor_temperature', self.on_temperature, 10)

    def on_set(self, parameters):
        new = {p.name: p.value for p in parameters}
        limit = new.get('limit_c', self.limit)
        self.limit = limit
        if str(limit) in (str(nan), str(inf), str(-inf)):
            return SetParametersResult(successful=False, reason='not a number that one can reach')
        if limit < -40 or limit > 125:
            return SetParametersResult(successful=False, reason='no motor is that cold or hot')
        self.place = new.get('place', self.place)
        return SetParametersResult(successful=True, reason='thank you')

    def on_temperature(self, message):
        if message.data > self.limit:
            self.get_logger().warning(f'{self.place}: {message.data}')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(LimitKeeper())


if __name__ == '__main__':
    main()
