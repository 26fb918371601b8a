import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from std_msgs.msg import Float64

ALLOWED = (-40.0, 125.0)


class LimitKeeper(Node):
    def __init__(self):
        Node.__init__(self, node_name='limit_keeper')
        self.declare_parameter('limit_c', value=30.0)
        self.declare_parameter('place', value='motor')
        self.add_on_set_parameters_callback(lambda ps: self.result(ps))
        self.create_subscription(
            msg_type=Float64, topic='motor_temperature', callback=self.hear, qos_profile=10)

    def result(self, parameters):
        for parameter in parameters:
            match (parameter.name, parameter.value):
                case ('limit_c', value) if not ALLOWED[0] <= value <= ALLOWED[1]:
                    return SetParametersResult(successful=False, reason=f'not in {ALLOWED}')
        return SetParametersResult(successful=True)

    def hear(self, message):
        if (limit := self.get_parameter('limit_c').value) < message.data:
            self.get_logger().warning(f'above {limit}')


def main():
    rclpy.init()
    node = LimitKeeper()
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=1.0)


if __name__ == '__main__':
    main()
