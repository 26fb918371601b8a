import threading

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Lookout(Node):

    def __init__(self):
        super().__init__('lookout', namespace='harbour')
        self.create_timer(1.0, lambda: self.get_logger().info('I see the sea.'))


class Keeper(Node):

    def __init__(self):
        super().__init__('keeper', namespace='harbour')
        self.wait()

    def wait(self):
        self.timer = threading.Timer(2.0, self.report)
        self.timer.daemon = True
        self.timer.start()

    def report(self):
        self.get_logger().info('The light is burning.')
        self.wait()


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    for node in (Lookout(), Keeper()):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
