from geometry_msgs.msg import Twist, Vector3
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import Float64


class Pilot(Node):
    """Only values that are fresh stay in self.fresh."""

    def __init__(self):
        super().__init__('pilot')
        self.declare_parameter('period_s', 0.5)
        self.declare_parameter('old_s', 2.0)
        self.known, self.fresh = set(), {}
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(Float64, 'speed', self.on_speed, 10)
        self.create_subscription(Float64, 'turn', self.on_turn, 10)
        self.create_timer(self.get_parameter('period_s').value, self.steer)

    def on_speed(self, message):
        self.remember('speed', message.data)

    def on_turn(self, message):
        self.remember('turn', message.data)

    def remember(self, name, value):
        self.known.add(name)
        self.fresh[name] = (value, self.get_clock().now())

    def steer(self):
        old = Duration(seconds=self.get_parameter('old_s').value)
        now = self.get_clock().now()
        self.fresh = {name: one for name, one in self.fresh.items() if now - one[1] <= old}
        if len(self.known) < 2:
            return
        command = Twist()
        if len(self.fresh) == 2:
            command = Twist(
                linear=Vector3(x=self.fresh['speed'][0]),
                angular=Vector3(z=self.fresh['turn'][0]),
            )
        self.commands.publish(command)


def main(args=None):
    rclpy.init(args=args)
    rclpy.spin(Pilot())


if __name__ == '__main__':
    main()
