import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class SafetyStop(Node):
    def __init__(self):
        super().__init__('safety_stop')
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Twist, 'cmd_vel_raw', self.guard, 10)
        self.silence = self.create_timer(0.65, self.stop, autostart=False)

    def guard(self, command):
        command.linear.x = max(-0.5, min(command.linear.x, 0.5))
        self.commands.publish(command)
        self.silence.reset()

    def stop(self):
        self.silence.cancel()
        self.commands.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(SafetyStop())


if __name__ == '__main__':
    main()
