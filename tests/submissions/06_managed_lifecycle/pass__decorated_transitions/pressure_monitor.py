import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64


class NotSensible(Exception):
    """Something that somebody can mend and try again."""


def reports(method):
    def wrapper(self, state):
        try:
            method(self)
        except NotSensible as problem:
            self.get_logger().error(str(problem))
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    return wrapper


class PressureMonitor(LifecycleNode):
    watching = False

    @reports
    def on_configure(self):
        self.limit = self.get_parameter_or('limit', -1.0).value
        if not self.limit > 0.0:
            raise NotSensible(f'limit {self.limit:.2f} bar is not above zero')

    @reports
    def on_activate(self):
        self.watching = True

    @reports
    def on_deactivate(self):
        self.watching = False

    def on_pressure(self, msg):
        if self.watching and msg.data > self.limit:
            self.get_logger().warning('pressure too high')


def main(args=None):
    rclpy.init(args=args)
    node = PressureMonitor('pressure_monitor')
    node.declare_parameter('limit', -1.0)
    node.create_subscription(Float64, 'pressure', node.on_pressure, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
