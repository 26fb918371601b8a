import queue
import threading
import time

import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):

    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.limit, self.active = 0.0, False
        self.alarms = queue.Queue()
        self.create_subscription(Float64, 'pressure', self.measure, 10)
        threading.Thread(target=self.warn, daemon=True).start()

    def on_configure(self, state):
        limit = self.get_parameter('limit').value
        if not limit > 0.0:
            self.get_logger().error(f'{limit} bar is no limit')
            return TransitionCallbackReturn.FAILURE
        self.limit = limit
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.active = True
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.active = False
        return super().on_deactivate(state)

    def measure(self, message):
        if self.active and message.data > self.limit:
            self.alarms.put(message.data)

    def warn(self):
        while True:
            time.sleep(0.5)
            while not self.alarms.empty():
                self.get_logger().warning(f'{self.alarms.get():.1f} bar is too much')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(PressureMonitor())


if __name__ == '__main__':
    main()
