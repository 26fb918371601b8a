import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import String


class Beacon(LifecycleNode):
    def __init__(self, **kwargs):
        super().__init__('beacon', **kwargs)
        self.ticks = 0

    def on_configure(self, state):
        self.pub = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        self.timer = self.create_timer(1 / 8, self.tick)
        return TransitionCallbackReturn.SUCCESS

    def tick(self):
        self.ticks += 1
        if self.ticks >= 8:
            self.ticks = 0
            self.pub.publish(String(data='flash'))

    def on_cleanup(self, state):
        self.destroy_timer(self.timer)
        self.destroy_lifecycle_publisher(self.pub)
        return TransitionCallbackReturn.SUCCESS


def main():
    rclpy.init()
    try:
        rclpy.spin(Beacon())
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
