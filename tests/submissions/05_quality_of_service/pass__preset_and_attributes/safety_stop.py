import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class SafetyStop(Node):
    def __init__(self):
        super().__init__('safety_stop')
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Twist, 'cmd_vel_raw', self.guard, 10)
        self.heard_s, self.standing = 0.0, True
        self.create_timer(0.02, self.look)

    def seconds(self):
        return self.get_clock().now().nanoseconds / 1e9

    def guard(self, command):
        if abs(command.linear.x) > 0.5:
            command.linear.x = 0.5 * command.linear.x / abs(command.linear.x)
        self.heard_s, self.standing = self.seconds(), False
        self.commands.publish(command)

    def look(self):
        if not self.standing and self.seconds() - self.heard_s > 0.5:
            self.standing = True
            self.commands.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(SafetyStop())


if __name__ == '__main__':
    main()
