import time

import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class Beacon(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')

    def on_configure(self, state):
        self.publisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        return super().on_configure(state)

    def on_activate(self, state):
        super().on_activate(state)
        while True:
            self.publisher.publish(String(data='flash'))
            time.sleep(1.0)

    def on_cleanup(self, state):
        self.destroy_lifecycle_publisher(self.publisher)
        return super().on_cleanup(state)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Beacon())


if __name__ == '__main__':
    main()
