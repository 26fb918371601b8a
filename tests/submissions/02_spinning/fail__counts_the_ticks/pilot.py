from geometry_msgs.msg import Twist
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.data = {}
        self.ticks = {}
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Float64, 'speed', lambda msg: self.store('speed', msg), 10)
        self.create_subscription(Float64, 'turn', lambda msg: self.store('turn', msg), 10)
        self.create_timer(0.5, self.tick)

    def store(self, name, msg):
        self.data[name] = msg.data
        self.ticks[name] = 0

    def tick(self):
        if len(self.data) < 2:
            return
        msg = Twist()
        for name in self.ticks:
            self.ticks[name] += 1
        if self.ticks['speed'] < 4 and self.ticks['turn'] < 4:
            msg.linear.x = self.data['speed']
            msg.angular.z = self.data['turn']
        self.pub.publish(msg)


rclpy.init()
rclpy.spin(Pilot())
