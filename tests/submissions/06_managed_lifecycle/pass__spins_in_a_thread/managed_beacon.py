import threading

import rclpy
from rclpy.lifecycle import LifecycleNode
from std_msgs.msg import String


class Beacon(LifecycleNode):
    pub = None

    def on_configure(self, state):
        self.pub = self.create_lifecycle_publisher(String, 'beacon_signal', 10)
        return super().on_configure(state)

    def on_cleanup(self, state):
        self.destroy_lifecycle_publisher(self.pub)
        self.pub = None
        return super().on_cleanup(state)


def main():
    rclpy.init()
    node = Beacon('beacon')
    thread = threading.Thread(target=rclpy.spin, args=(node,), daemon=True)
    thread.start()
    rate = node.create_rate(1.0)
    while rclpy.ok():
        rate.sleep()
        if node.pub:
            node.pub.publish(String(data='from the main thread'))


if __name__ == '__main__':
    main()
