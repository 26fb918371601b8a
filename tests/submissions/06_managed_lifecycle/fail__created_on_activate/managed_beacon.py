import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class Beacon(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')

    def on_configure(self, state):
        self.get_logger().info('configured')
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state):
        self.pub = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.timer = self.create_timer(1.0, self.flash)
        return super().on_activate(state)

    def on_deactivate(self, state):
        result = super().on_deactivate(state)
        self.destroy_timer(self.timer)
        self.destroy_lifecycle_publisher(self.pub)
        return result

    def on_cleanup(self, state):
        return TransitionCallbackReturn.SUCCESS

    def flash(self):
        self.pub.publish(String(data='flash'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Beacon())


if __name__ == '__main__':
    main()
