import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class SafetyStop(Node):
    def __init__(self):
        super().__init__('safety_stop')
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.sub = self.create_subscription(Twist, 'cmd_vel_raw', self.callback, 10)
        self.timer = self.create_timer(0.05, self.timer_callback)
        self.last_time = None

    def callback(self, msg):
        new_msg = Twist()
        new_msg.linear.x = msg.linear.x
        if new_msg.linear.x > 0.5:
            new_msg.linear.x = 0.5
        if new_msg.linear.x < -0.5:
            new_msg.linear.x = -0.5
        new_msg.angular.z = msg.angular.z
        self.pub.publish(new_msg)
        self.last_time = self.get_clock().now()

    def timer_callback(self):
        if self.last_time is None:
            return
        age = (self.get_clock().now() - self.last_time).nanoseconds
        if age >= 500000000:
            self.pub.publish(Twist())
            self.last_time = None


def main():
    rclpy.init()
    rclpy.spin(SafetyStop())


if __name__ == '__main__':
    main()
