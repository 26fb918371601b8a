from geometry_msgs.msg import Twist
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Input:
    """The latest value of a topic, and a timer that fires when it is old."""

    def __init__(self, node, topic):
        self.value, self.fresh = None, False
        node.create_subscription(Float64, topic, self.hear, 10)
        self.watchdog = node.create_timer(2.0, self.grow_old, autostart=False)

    def hear(self, message):
        self.value, self.fresh = message.data, True
        self.watchdog.reset()

    def grow_old(self):
        self.fresh = False
        self.watchdog.cancel()


class Pilot(Node):
    def __init__(self):
        super().__init__('pilot')
        self.speed, self.turn = Input(self, 'speed'), Input(self, 'turn')
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_timer(0.5, self.steer)

    def steer(self):
        if self.speed.value is None or self.turn.value is None:
            return
        command = Twist()
        if self.speed.fresh and self.turn.fresh:
            command.linear.x, command.angular.z = self.speed.value, self.turn.value
        self.commands.publish(command)


def main():
    rclpy.init()
    rclpy.spin(Pilot())


if __name__ == '__main__':
    main()
