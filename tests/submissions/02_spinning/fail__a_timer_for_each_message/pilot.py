import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_msgs.msg import Float64


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.data, self.when = {}, {}
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Float64, 'speed', self.speed, 10)
        self.create_subscription(Float64, 'turn', self.turn, 10)

    def speed(self, msg):
        self.store('speed', msg)

    def turn(self, msg):
        self.store('turn', msg)

    def store(self, name, msg):
        self.data[name] = msg.data
        self.when[name] = self.get_clock().now().nanoseconds
        if len(self.data) == 2:
            self.create_timer(0.5, self.tick)

    def tick(self):
        msg = Twist()
        if self.get_clock().now().nanoseconds - min(self.when.values()) <= 2e9:
            msg.linear.x = self.data['speed']
            msg.angular.z = self.data['turn']
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(Pilot())
