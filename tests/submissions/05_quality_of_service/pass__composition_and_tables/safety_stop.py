import threading

from geometry_msgs.msg import Twist
import rclpy

LIMITS = {'linear': (-0.5, 0.5)}


class Watchdog:
    def __init__(self, bark):
        self.bark, self.timer = bark, None

    def feed(self):
        if self.timer:
            self.timer.cancel()
        self.timer = threading.Timer(0.5, self.bark)
        self.timer.daemon = True
        self.timer.start()


class SafetyStop:
    def __init__(self, node):
        self.commands = node.create_publisher(Twist, 'cmd_vel', 10)
        self.dog = Watchdog(lambda: self.commands.publish(Twist()))
        node.create_subscription(Twist, 'cmd_vel_raw', self.guard, 10)

    def guard(self, command):
        low, high = LIMITS['linear']
        command.linear.x = min(max(command.linear.x, low), high)
        self.commands.publish(command)
        self.dog.feed()


def main():
    rclpy.init()
    node = rclpy.create_node('safety_stop')
    keep = SafetyStop(node)
    rclpy.spin(node)
    del keep


if __name__ == '__main__':
    main()
