import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.speed = None
        self.turn = None
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Float64, 'speed', self.on_speed, 10)
        self.create_subscription(Float64, 'turn', self.on_turn, 10)
        self.create_timer(0.5, self.steer)

    def on_speed(self, msg):
        self.speed = msg.data

    def on_turn(self, msg):
        self.turn = msg.data

    def steer(self):
        if self.speed is None or self.turn is None:
            return
        msg = Twist()
        msg.linear.x = self.speed
        msg.angular.z = self.turn
        self.pub.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Pilot())


if __name__ == '__main__':
    main()
