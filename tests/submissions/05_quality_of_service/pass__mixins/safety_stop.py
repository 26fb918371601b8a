import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Limits:
    def limit(self, value):
        return max(-0.5, min(0.5, value))


class Watches:
    def watch(self, seconds, callback):
        self._timer = self.create_timer(seconds, callback)
        self._timer.cancel()

    def seen(self):
        self._timer.reset()

    def unwatch(self):
        self._timer.cancel()


class SafetyStop(Limits, Watches, Node):
    def __init__(self):
        super().__init__('safety_stop')
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.watch(0.5, self.stop)
        self.create_subscription(Twist, 'cmd_vel_raw', self.guard, 10)

    def guard(self, command):
        self.seen()
        command.linear.x = self.limit(command.linear.x)
        self.commands.publish(command)

    def stop(self):
        self.unwatch()
        self.commands.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(SafetyStop())


if __name__ == '__main__':
    main()
