import threading

import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Watcher(Node):
    def __init__(self, name, hz):
        super().__init__(name, namespace='harbour')
        self.rate = self.create_rate(hz)
        self.thread = threading.Thread(target=self.work, daemon=True)
        self.thread.start()

    def work(self):
        while rclpy.ok():
            self.rate.sleep()
            self.get_logger().info(f'{self.get_name()}: ok')


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor()
    executor.add_node(Watcher('lookout', 1.0))
    executor.add_node(Watcher('keeper', 0.5))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
