import rclpy
from rcl_interfaces.msg import SetParametersResult
from std_msgs.msg import Float64


def checked(value):
    if not -40.0 <= value <= 125.0:
        raise ValueError(f'{value} is no limit from -40.0 to 125.0 degC')
    return value


def validate(parameters):
    try:
        for parameter in parameters:
            if parameter.name == 'limit_c':
                checked(parameter.value)
    except ValueError as error:
        return SetParametersResult(successful=False, reason='')
    return SetParametersResult(successful=True)


def main():
    rclpy.init()
    node = rclpy.create_node('limit_keeper')
    node.add_on_set_parameters_callback(validate)
    limit = node.declare_parameter('limit_c', 30.0)
    node.declare_parameter('place', 'motor')

    def judge(message):
        if message.data > node.get_parameter(limit.name).value:
            node.get_logger().warning(f'too warm: {message.data}')

    node.create_subscription(Float64, 'motor_temperature', judge, 10)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
