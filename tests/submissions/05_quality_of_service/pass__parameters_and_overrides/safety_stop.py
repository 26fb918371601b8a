import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class SafetyStop(Node):
    def __init__(self):
        super().__init__('safety_stop')
        self.declare_parameter('max_speed', 0.5)
        self.declare_parameter('silence_s', 0.5)
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Twist, 'cmd_vel_raw', self.guard, 10)
        self.silence = self.create_timer(self.get_parameter('silence_s').value, self.stop)
        self.silence.cancel()

    def guard(self, command):
        most = self.get_parameter('max_speed').value
        command.linear.x = max(-most, min(command.linear.x, most))
        self.commands.publish(command)
        self.silence.reset()

    def stop(self):
        self.silence.cancel()
        self.get_logger().warning('No command: stop')
        self.commands.publish(Twist())


def main():
    rclpy.init()
    rclpy.spin(SafetyStop())


if __name__ == '__main__':
    main()
