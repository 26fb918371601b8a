from geometry_msgs.msg import Twist
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Keeps:
    """Something with a latest value for each topic, which is None before the first one."""

    kept = ()

    def keep(self, topic):
        setattr(self, topic, None)
        self.create_subscription(Float64, topic, lambda m: self._store(topic, m.data), 10)

    def _store(self, topic, value):
        setattr(self, topic, (self.get_clock().now(), value))

    def fresh(self, topic):
        return (self.get_clock().now() - getattr(self, topic)[0]).nanoseconds <= 2e9


class Pilot(Keeps, Node):
    def __init__(self):
        Node.__init__(self, 'pilot')
        self.keep('speed')
        self.keep('turn')
        self.out = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_timer(0.5, self.steer)

    def steer(self):
        if not (self.speed and self.turn):  # pairs, so a speed of zero is no None
            return
        twist = Twist()
        if self.fresh('speed') and self.fresh('turn'):
            twist.linear.x = self.speed[1]
            twist.angular.z = self.turn[1]
        self.out.publish(twist)


rclpy.init()
rclpy.spin(Pilot())
