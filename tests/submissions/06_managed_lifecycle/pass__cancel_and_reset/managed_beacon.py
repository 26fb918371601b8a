import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class Beacon(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')

    def on_configure(self, state):
        self.pub = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        # autostart=False: waits until somebody resets it
        self.timer = self.create_timer(1.0, self.blink, autostart=False)
        return super().on_configure(state)

    def on_activate(self, state):
        self.timer.reset()
        return super().on_activate(state)

    def on_deactivate(self, state):
        self.timer.cancel()
        return super().on_deactivate(state)

    def on_cleanup(self, state):
        self.timer.destroy()
        self.destroy_timer(self.timer)
        self.destroy_lifecycle_publisher(self.pub)
        del self.pub, self.timer
        return super().on_cleanup(state)

    def blink(self):
        self.pub.publish(String(data='blink'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Beacon())
    rclpy.shutdown()


if __name__ == '__main__':
    main()
