from dataclasses import dataclass

from geometry_msgs.msg import Twist
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Float64


@dataclass
class Latest:
    value: float
    at: Time


class Pilot(Node):
    def __init__(self) -> None:
        super().__init__('pilot')
        self.latest: dict[str, Latest] = {}
        self.timer = None
        self.commands = self.create_publisher(Twist, 'cmd_vel', 10)
        for topic in ('speed', 'turn'):
            self.create_subscription(
                Float64, topic, lambda message, topic=topic: self.hear(topic, message), 10)

    def hear(self, topic: str, message: Float64) -> None:
        self.latest[topic] = Latest(message.data, self.get_clock().now())
        if self.timer is None and len(self.latest) == 2:
            self.timer = self.create_timer(0.5, self.steer)

    def steer(self) -> None:
        now = self.get_clock().now()
        command = Twist()
        if any(now - one.at > Duration(seconds=2.0) for one in self.latest.values()):
            return
        command.linear.x = self.latest['speed'].value
        command.angular.z = self.latest['turn'].value
        self.commands.publish(command)


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    rclpy.spin(Pilot())


if __name__ == '__main__':
    main()
