#!/usr/bin/env python3
"""Watch a pressure, once somebody has set a limit that makes sense."""

import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    """A monitor that refuses to be configured without a sensible limit."""

    def __init__(self):
        """Create the node, its parameter and its subscription."""
        # 1. Hand the node name to the parent class, then
        #    declare_parameter(name, default) and create_subscription(type, topic, method, depth)

        super().__init__('pressure_monitor')
        self.declare_parameter('limit', -1.0)
        self.create_subscription(Float64, 'pressure', self.judge, 10)

        self.limit = 0.0  # of the last configuration [bar]
        self.watching = False  # whether we are active

    def on_configure(self, state):
        """
        Take over the limit, or refuse it.

        :param state: where we come from
        :returns: SUCCESS, or FAILURE for a limit that is not above zero
        """
        # 2. Read the parameter: self.get_parameter('limit').value
        # 3. Not above zero: one log.error with the limit in it, and return FAILURE.
        # 4. Else remember it in self.limit, and return what the parent class returns.

        limit = self.get_parameter('limit').value
        if not limit > 0.0:
            self.get_logger().error(f'A limit of {limit} bar is not above zero')
            return TransitionCallbackReturn.FAILURE
        self.limit = limit
        return super().on_configure(state)


    def on_activate(self, state):
        """
        Begin to watch.

        :param state: where we come from
        :returns: how it went
        """
        # 5. Remember in self.watching that we are active. What has to be returned?

        self.watching = True
        return super().on_activate(state)


    def on_deactivate(self, state):
        """
        Stop watching.

        :param state: where we come from
        :returns: how it went
        """
        # 6. The opposite of on_activate().

        self.watching = False
        return super().on_deactivate(state)


    def judge(self, message):
        """
        Warn if we are active and the pressure is strictly above the limit.

        :param message: the Float64 that has arrived [bar]
        """
        # 7. A subscription hears messages in every state: look at self.watching first.
        # 8. Strictly above self.limit: self.get_logger().warning(...)

        if self.watching and message.data > self.limit:
            text = f'{message.data:.2f} bar is above {self.limit:.2f} bar'
            threading.Timer(1.5, self.get_logger().warning, [text]).start()



def main(args=None):
    """Run the node until it is interrupted or terminated."""
    rclpy.init(args=args)
    node = PressureMonitor()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
