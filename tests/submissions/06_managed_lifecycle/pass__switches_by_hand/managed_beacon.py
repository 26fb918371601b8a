import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.qos import QoSProfile
from std_msgs.msg import String


class Beacon(LifecycleNode):
    """Calls its publisher itself where the parent class would."""

    def on_configure(self, state):
        self.flasher = self.create_lifecycle_publisher(
            msg_type=String, topic='beacon_signal', qos_profile=QoSProfile(depth=10)
        )
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.flasher.on_activate(state)
        self.clockwork = self.create_timer(timer_period_sec=1.0, callback=self.flash)
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state):
        self.flasher.on_deactivate(state)
        self.destroy_timer(self.clockwork)
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state):
        self.destroy_lifecycle_publisher(self.flasher)
        return TransitionCallbackReturn.SUCCESS

    def flash(self):
        self.flasher.publish(String(data=str(self.get_clock().now().nanoseconds)))


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Beacon('beacon'))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
