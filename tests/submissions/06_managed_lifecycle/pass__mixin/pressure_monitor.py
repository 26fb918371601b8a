import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class Awake:
    """Knows whether its node is active."""

    awake = False

    def on_activate(self, state):
        result = super().on_activate(state)
        self.awake = result == TransitionCallbackReturn.SUCCESS
        return result

    def on_deactivate(self, state):
        self.awake = False
        return super().on_deactivate(state)


def when_awake(callback):
    return lambda self, message: callback(self, message) if self.awake else None


class PressureMonitor(Awake, LifecycleNode):
    def __init__(self):
        super().__init__('pressure_monitor')
        self.declare_parameters('', [('limit', -1.0)])
        self.create_subscription(Float64, 'pressure', self.judge, 10)

    @property
    def wanted_limit(self):
        return self.get_parameter('limit').value

    def on_configure(self, state):
        if not self.wanted_limit > 0:
            self.get_logger().error(f'a limit of {self.wanted_limit} bar cannot be watched')
            return TransitionCallbackReturn.FAILURE
        self.limit = self.wanted_limit
        return super().on_configure(state)

    @when_awake
    def judge(self, message):
        if message.data > self.limit:
            self.get_logger().warning(f'{message.data:.2f} bar')


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(PressureMonitor())


if __name__ == '__main__':
    main()
