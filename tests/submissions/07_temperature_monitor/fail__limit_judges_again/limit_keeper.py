import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rcl_interfaces.msg import SetParametersResult
from std_msgs.msg import Float64


class Keeper(Node):
    def __init__(self):
        super().__init__('limit_keeper')
        self.limit = self.declare_parameter('limit_c', 30.0).value
        self.declare_parameter('place', 'motor')
        self.add_on_set_parameters_callback(self.allowed)
        self.add_post_set_parameters_callback(self.new_limit)
        self.create_subscription(Float64, 'motor_temperature', self.heard, 10)

    def allowed(self, params):
        for param in params:
            if param.name == 'limit_c' and not -40.0 <= param.value <= 125.0:
                return SetParametersResult(successful=False, reason='use -40.0 to 125.0')
        return SetParametersResult(successful=True)

    def new_limit(self, params):
        for param in params:
            if param.name == 'limit_c':
                self.limit = param.value
                self.compare()

    def heard(self, msg):
        self.now = msg.data
        self.compare()

    def compare(self):
        if hasattr(self, 'now') and self.now > self.limit:
            self.get_logger().warning(f'{self.now} is more than {self.limit}')


def main():
    rclpy.init()
    keeper = Keeper()
    try:
        rclpy.spin(keeper)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        keeper.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
