import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    """Transitions and pressures may come on different threads, so a lock guards both."""

    def __init__(self):
        super().__init__('pressure_monitor')
        self.lock = threading.Lock()
        self.limit = None
        self.on_duty = threading.Event()
        self.declare_parameter('limit', -1.0)
        group = ReentrantCallbackGroup()
        self.create_subscription(Float64, 'pressure', self.heard, 10, callback_group=group)

    def on_configure(self, state):
        value = self.get_parameter('limit').value
        if not value > 0:
            self.get_logger().error(f'limit is {value}, must be > 0')
            return TransitionCallbackReturn.FAILURE
        with self.lock:
            self.limit = value
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.on_duty.set()
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state):
        self.on_duty.clear()
        return TransitionCallbackReturn.SUCCESS

    def heard(self, msg):
        with self.lock:
            limit = self.limit
        if self.on_duty.is_set() and msg.data > limit:
            self.get_logger().warning(f'{msg.data} > {limit}')


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(PressureMonitor())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
