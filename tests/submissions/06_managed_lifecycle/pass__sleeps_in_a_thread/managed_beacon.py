import threading
import time

import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class Beacon(LifecycleNode):
    def __init__(self):
        super().__init__('beacon')
        self.publisher = None
        threading.Thread(target=self.work, daemon=True).start()

    def on_configure(self, state):
        self.publisher = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        return super().on_configure(state)

    def on_cleanup(self, state):
        self.destroy_lifecycle_publisher(self.publisher)
        self.publisher = None
        return super().on_cleanup(state)

    def work(self):
        while True:
            time.sleep(1.0)
            if self.publisher is not None:
                self.publisher.publish(String(data='flash'))


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Beacon())


if __name__ == '__main__':
    main()
