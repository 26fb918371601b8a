#!/usr/bin/env python3
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class Beacon(LifecycleNode):

    def __init__(self):
        super().__init__('beacon')
        self._pub = None
        self._timer = None
        self._count = 0

    def on_configure(self, state):
        self.get_logger().info('on_configure()')
        self._pub = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.get_logger().info('on_activate()')
        self._timer = self.create_timer(1.0, self._publish)
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.get_logger().info('on_deactivate()')
        self.destroy_timer(self._timer)
        self._timer = None
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        self.get_logger().info('on_cleanup()')
        self.destroy_publisher(self._pub)
        self._pub = None
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state):
        self.get_logger().info('on_shutdown()')
        if self._timer is not None:
            self.destroy_timer(self._timer)
        if self._pub is not None:
            self.destroy_publisher(self._pub)
        return TransitionCallbackReturn.SUCCESS

    def _publish(self):
        msg = String()
        msg.data = 'Beacon #' + str(self._count)
        self._count += 1
        self._pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = Beacon()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        node.destroy_node()


if __name__ == '__main__':
    main()
