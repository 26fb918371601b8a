import rclpy
from rclpy.node import Node
from rcl_interfaces.msg import SetParametersResult
from std_msgs.msg import Float64

rclpy.init()
node = Node('limit_keeper')
node.declare_parameter('limit_c', 30.0)
node.declare_parameter('place', 'motor')

def check_params(params):
    res = SetParametersResult()
    res.successful = True
    for p in params:
        if p.name == 'limit_c':
            if p.value < -40.0:
                res.successful = False
                res.reason = 'too low'
            elif p.value > 125.0:
                res.successful = False
                res.reason = 'too high'
    return res

def cb(msg):
    limit = node.get_parameter('limit_c').value
    if msg.data > limit:
        node.get_logger().warning('too hot: ' + str(msg.data))

node.add_on_set_parameters_callback(check_params)
node.create_subscription(Float64, 'motor_temperature', cb, 10)
rclpy.spin(node)
