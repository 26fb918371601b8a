import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class Managed(LifecycleNode):
    """A node that knows whether it is active."""

    active = False

    def on_activate(self, state):
        self.active = True
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.active = False
        return super().on_deactivate(state)


class Beacon(Managed):
    def on_configure(self, state):
        self.out = self.create_publisher(String, 'beacon_signal', 10)
        group = MutuallyExclusiveCallbackGroup()
        self.timer = self.create_timer(1.0, self.flash, callback_group=group)
        return super().on_configure(state)

    def on_cleanup(self, state):
        self.destroy_timer(self.timer)
        self.destroy_publisher(self.out)
        return super().on_cleanup(state)

    def flash(self):
        if self.active:
            self.out.publish(String(data='flash'))


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(Beacon('beacon'))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
