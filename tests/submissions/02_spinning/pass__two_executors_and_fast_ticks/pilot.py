from geometry_msgs.msg import Twist
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

TICK_S = 0.1


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.ticks = 0
        self.inputs = {'speed': None, 'turn': None}
        self.ages = {'speed': 0.0, 'turn': 0.0}
        self.pub = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Float64, 'speed', self.on_speed, 10)
        self.create_subscription(Float64, 'turn', self.on_turn, 10)
        self.create_timer(TICK_S, self.tick)

    def on_speed(self, msg):
        self.inputs['speed'], self.ages['speed'] = msg.data, 0.0

    def on_turn(self, msg):
        self.inputs['turn'], self.ages['turn'] = msg.data, 0.0

    def tick(self):
        self.ticks += 1
        for name in self.ages:
            self.ages[name] += TICK_S
        if self.ticks % 5 == 0:
            self.steer()

    def steer(self):
        if any(value is None for value in self.inputs.values()):
            return
        stop = max(self.ages.values()) > 2.0 + TICK_S / 2
        twist = Twist()
        twist.linear.x = 0.0 if stop else self.inputs['speed']
        twist.angular.z = 0.0 if stop else self.inputs['turn']
        self.pub.publish(twist)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Pilot())


if __name__ == '__main__':
    main()
