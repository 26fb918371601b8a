import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Guard(Node):
    limit = 0.5

    def __init__(self):
        super().__init__('safety_stop')
        out = self.create_publisher(Twist, 'cmd_vel', 10)
        watch = self.create_timer(0.5, lambda: (watch.cancel(), out.publish(Twist())), autostart=False)
        self.create_subscription(
            Twist, 'cmd_vel_raw', lambda m: (out.publish(self.slow(m)), watch.reset()), 10)

    def slow(self, message):
        message.linear.x = sorted((-self.limit, message.linear.x, self.limit))[1]
        return message


class SafetyStop(Guard):
    pass


def main():
    rclpy.init()
    rclpy.spin(SafetyStop())


if __name__ == '__main__':
    main()
