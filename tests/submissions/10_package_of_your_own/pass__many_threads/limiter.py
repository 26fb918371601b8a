import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64


class SpeedLimiter(Node):
    def __init__(self):
        super().__init__('limiter')
        self.lock = threading.Lock()
        self.declare_parameter('max_speed', 1.0)
        self.out = self.create_publisher(Float64, 'speed', 10)
        self.create_subscription(
            Float64, 'wanted_speed', self.cut, 10, callback_group=ReentrantCallbackGroup()
        )

    def cut(self, msg):
        with self.lock:
            limit = self.get_parameter('max_speed').value
            value = msg.data
            value = limit if value > limit else -limit if value < -limit else value
            self.out.publish(Float64(data=value))


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(4)
    executor.add_node(SpeedLimiter())
    executor.spin()
