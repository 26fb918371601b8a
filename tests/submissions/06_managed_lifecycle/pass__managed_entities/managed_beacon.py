import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.lifecycle.managed_entity import ManagedEntity
from std_msgs.msg import String


class ManagedTimer(ManagedEntity):
    """A timer that runs while its node is active."""

    def __init__(self, node, period_s, callback):
        self.node, self.period_s, self.callback = node, period_s, callback
        node.add_managed_entity(self)

    def on_activate(self, state):
        self.timer = self.node.create_timer(self.period_s, self.callback)
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state):
        self.node.destroy_timer(self.timer)
        return TransitionCallbackReturn.SUCCESS


class Beacon(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')
        ManagedTimer(self, 1.0, self.flash)

    def on_configure(self, state):
        self.out = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        return super().on_configure(state)

    def on_cleanup(self, state):
        self.destroy_lifecycle_publisher(self.out)
        return super().on_cleanup(state)

    def flash(self):
        self.out.publish(String(data='managed'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Beacon())


if __name__ == '__main__':
    main()
