import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class PressureMonitor(LifecycleNode):
    """Hears of each new limit, and takes it over when it is configured."""

    def __init__(self):
        super().__init__('pressure_monitor')
        self.limit = None
        self.on_duty = False
        self.add_on_set_parameters_callback(self.heard_of)
        self.declare_parameter('limit', -1.0)
        self.create_subscription(Float64, 'pressure', self.compare, 10)

    def heard_of(self, parameters):
        for parameter in parameters:
            if parameter.name == 'limit':
                self.next_limit = parameter.value
        return SetParametersResult(successful=True)

    def on_configure(self, state):
        if not self.next_limit > 0.0:
            self.get_logger().error(f'{self.next_limit} bar: refused')
            return TransitionCallbackReturn.FAILURE
        self.limit = self.next_limit
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.on_duty = True
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state):
        self.on_duty = False
        return TransitionCallbackReturn.SUCCESS

    def compare(self, message):
        if not (self.on_duty and message.data > self.limit):
            return
        self.get_logger().warning(f'above {self.limit} bar: {message.data}')


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(PressureMonitor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
