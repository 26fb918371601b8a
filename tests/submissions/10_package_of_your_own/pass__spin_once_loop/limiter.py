import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


def main(args=None):
    rclpy.init(args=args)
    node = Node('limiter')
    node.declare_parameter('max_speed', 1.0)
    publisher = node.create_publisher(Float64, 'speed', 10)
    waiting = []
    node.create_subscription(Float64, 'wanted_speed', waiting.append, 10)
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.1)
        limit = node.get_parameter('max_speed').value
        while waiting:
            speed = waiting.pop(0).data
            publisher.publish(Float64(data=max(min(speed, limit), -limit)))
