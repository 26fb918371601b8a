from functools import partial
import math
import threading

from rcl_interfaces.msg import SetParametersResult
import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Float64

ACCEPT = partial(SetParametersResult, successful=True)
REFUSE = partial(SetParametersResult, successful=False)


class LimitKeeper(Node):
    def __init__(self):
        super().__init__('limit_keeper')
        self.lock = threading.Lock()
        self.declare_parameter('limit_c', 30.0)
        self.declare_parameter('place', 'motor')
        self.add_on_set_parameters_callback(self.check_limit)
        self.add_on_set_parameters_callback(self.check_place)
        self.create_subscription(
            Float64, 'motor_temperature', self.judge, 10,
            callback_group=ReentrantCallbackGroup())

    def check_place(self, parameters):
        texts = [one.value for one in parameters if one.name == 'place']
        return ACCEPT() if all(isinstance(one, str) for one in texts) else REFUSE(reason='no text')

    def check_limit(self, parameters):
        for one in parameters:
            if one.name == 'limit_c' and not math.isfinite(one.value):
                return REFUSE(reason='not finite')
            if one.name == 'limit_c' and not (-40.0 <= one.value <= 125.0):
                return REFUSE(reason='out of range')
        return ACCEPT()

    def judge(self, message):
        with self.lock:
            if message.data > self.get_parameter('limit_c').value:
                self.get_logger().warning('hot')


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    executor.add_node(LimitKeeper())
    executor.spin()


if __name__ == '__main__':
    main()
