#!/usr/bin/env python3
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class CountingMixin:
    """Counts from one."""

    _count = 0

    def next_number(self):
        self._count += 1
        return self._count


class NightWatch(CountingMixin, Node):
    def __init__(self):
        super().__init__('night_watch')
        self.declare_parameter('period', 1.0)
        self.declare_parameter('warn_every', 5)
        self.warn_every = self.get_parameter('warn_every').value
        self.create_timer(self.get_parameter('period').value, self.on_timer)

    def on_timer(self):
        number = self.next_number()
        if number % self.warn_every:
            self.get_logger().info(f'Watch no. {number}')
        else:
            self.get_logger().warning(f'Watch no. {number} (relief!)')


def main(args=None):
    rclpy.init(args=args)
    node = NightWatch()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
