from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class PeriodicPublisher(Node):
    """Publishes what make_message() returns, once a period."""

    topic = None
    msg_type = None

    def __init__(self, name, *, period):
        super().__init__(name)
        self._out = self.create_publisher(self.msg_type, self.topic, 10)
        self.create_timer(period, self._on_timer)

    def _on_timer(self):
        self._out.publish(self.make_message())

    def make_message(self):
        raise TypeError('a subclass makes the message')


class CountingMixin:
    number = 0

    def count(self):
        self.number += 1
        return self.number


class Talker(CountingMixin, PeriodicPublisher):
    topic = 'chatter'
    msg_type = String

    def make_message(self):
        return String(data=f'hello {self.count()}')


make_talker = partial(Talker, 'talker', period=0.5)


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(make_talker())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
