#!/usr/bin/env python3
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):

    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self._sub = None
        self._active = False

    def on_configure(self, state):
        self._limit = self.get_parameter('limit').get_parameter_value().double_value
        if not self._limit > 0.0:
            self.get_logger().error('limit must be above zero, got %.3f' % self._limit)
            return TransitionCallbackReturn.FAILURE
        self._sub = self.create_subscription(Float64, 'pressure', self._callback, 10)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self._active = True
        return super().on_activate(state)

    def on_deactivate(self, state):
        self._active = False
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        self.destroy_subscription(self._sub)
        self._sub = None
        return TransitionCallbackReturn.SUCCESS

    def _callback(self, msg):
        if not self._active:
            return
        if msg.data > self._limit:
            self.get_logger().warning('pressure %.2f is above %.2f' % (msg.data, self._limit))


def main(args=None):
    rclpy.init(args=args)
    node = PressureMonitor()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        node.destroy_node()


if __name__ == '__main__':
    main()
