import rclpy
from rclpy.node import Node
from rcl_interfaces.msg import SetParametersResult
from std_msgs.msg import Float64


class LimitKeeper(Node):
    def __init__(self):
        super().__init__('limit_keeper')
        self.declare_parameter('limit_c', 30.0)
        self.declare_parameter('place', 'motor')
        self.add_on_set_parameters_callback(self.check)
        self.sub = self.create_subscription(Float64, 'motor_temperature', self.callback, 10)

    def check(self, params):
        for p in params:
            if p.name == 'limit_c':
                ok = p.value >= -40.0 and p.value <= 125.0
                return SetParametersResult(successful=ok, reason='' if ok else 'not sensible')

    def callback(self, msg):
        if msg.data > self.get_parameter('limit_c').value:
            self.get_logger().warn('warning: %f' % msg.data)


def main():
    rclpy.init()
    node = LimitKeeper()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
