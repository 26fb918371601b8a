import signal
import sys
from threading import Thread

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.watches = 0
        self.timer = self.create_timer(1.0, self.one_more)

    def one_more(self):
        self.watches += 1
        print('watch', self.watches, file=sys.stderr)
        say = self.say_loud if self.watches % 5 == 0 else self.say
        say(f'Watch {self.watches} of the night')

    def say(self, text):
        self.get_logger().info(text)

    def say_loud(self, text):
        self.get_logger().warn(text)


def main():
    rclpy.init(args=sys.argv, signal_handler_options=SignalHandlerOptions.NO)
    executor = SingleThreadedExecutor()
    executor.add_node(NightWatch())
    Thread(target=executor.spin, daemon=True).start()
    signal.sigwait({signal.SIGINT, signal.SIGTERM})
    executor.shutdown()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
