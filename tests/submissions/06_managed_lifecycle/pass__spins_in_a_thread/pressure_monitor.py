from threading import Thread

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.sub = None

    def on_configure(self, state):
        self.limit = self.get_parameter('limit').value
        if not self.limit > 0:
            self.get_logger().error(f'bad limit: {self.limit}')
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.sub = self.create_subscription(Float64, 'pressure', self.compare, 10)
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state):
        self.destroy_subscription(self.sub)
        self.sub = None
        return TransitionCallbackReturn.SUCCESS

    def compare(self, msg):
        if self.sub is not None and self.limit < msg.data:
            self.get_logger().warning(f'{msg.data - self.limit:.2f} bar too much')


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(PressureMonitor())
    spinner = Thread(target=executor.spin)
    spinner.start()
    spinner.join()


if __name__ == '__main__':
    main()
