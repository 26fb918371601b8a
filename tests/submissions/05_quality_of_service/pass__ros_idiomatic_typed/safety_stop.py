from __future__ import annotations

from geometry_msgs.msg import Twist
import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time

SILENCE = Duration(seconds=0.5)


class SafetyStop(Node):
    """Looks every 0.1 s whether the last command is old."""

    def __init__(self) -> None:
        super().__init__('safety_stop')
        self._commands = self.create_publisher(Twist, 'cmd_vel', 10)
        self._heard: Time | None = None
        self.create_subscription(Twist, 'cmd_vel_raw', self._guard, 10)
        self.create_timer(0.1, self._look)

    def _guard(self, command: Twist) -> None:
        command.linear.x = max(-0.5, min(command.linear.x, 0.5))
        self._commands.publish(command)
        self._heard = self.get_clock().now()

    def _look(self) -> None:
        if self._heard is not None and self.get_clock().now() - self._heard >= SILENCE:
            self._heard = None
            self._commands.publish(Twist())


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    node = SafetyStop()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
