import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class Beacon(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')
        self.timer = None

    def on_configure(self, state):
        self.publisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        if self.timer is None:
            self.timer = self.create_timer(1.0, self.flash)
        return TransitionCallbackReturn.SUCCESS

    def on_cleanup(self, state):
        self.destroy_timer(self.timer)
        self.destroy_lifecycle_publisher(self.publisher)
        return TransitionCallbackReturn.SUCCESS

    def flash(self):
        self.publisher.publish(String(data='flash'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Beacon())


if __name__ == '__main__':
    main()
