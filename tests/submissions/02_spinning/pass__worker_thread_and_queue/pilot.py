import threading
import time

from geometry_msgs.msg import Twist
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.lock = threading.Lock()
        self.values, self.times = [None, None], [0.0, 0.0]
        self.out = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Float64, 'speed', lambda m: self.keep(0, m.data), 10)
        self.create_subscription(Float64, 'turn', lambda m: self.keep(1, m.data), 10)

    def keep(self, index, value):
        with self.lock:
            self.values[index] = value
            self.times[index] = time.monotonic()

    def steer_for_ever(self):
        while rclpy.ok():
            time.sleep(0.5)
            with self.lock:
                values, oldest = list(self.values), min(self.times)
            if None in values:
                continue
            twist = Twist()
            if time.monotonic() - oldest <= 2.0:
                twist.linear.x, twist.angular.z = values
            self.out.publish(twist)


def main():
    rclpy.init()
    node = Pilot()
    threading.Thread(target=node.steer_for_ever, daemon=True).start()
    rclpy.spin(node)


if __name__ == '__main__':
    main()
