import functools
import traceback

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


def transition(method):
    """Log the exception that rclpy would swallow; without one, go on with the parent class."""

    @functools.wraps(method)
    def wrapper(self, state):
        try:
            method(self)
            return getattr(super(Beacon, self), method.__name__)(state)
        except Exception:
            self.get_logger().error(traceback.format_exc())
            return TransitionCallbackReturn.ERROR

    return wrapper


class Beacon(LifecycleNode):
    @transition
    def on_configure(self):
        self.signal = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.heart = self.create_timer(1.0, self.beat)

    @transition
    def on_cleanup(self):
        self.destroy_lifecycle_publisher(self.signal)
        self.destroy_timer(self.heart)

    def beat(self):
        if self.signal.is_activated:
            self.signal.publish(String(data='beat'))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Beacon('beacon'))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
