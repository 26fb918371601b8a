import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node


class Reporter(Node):
    def __init__(self, name, seconds):
        super().__init__(name, namespace='/harbour')
        self.seconds = seconds
        self.elapsed = 0.0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.elapsed += 0.1
        if self.elapsed > self.seconds - 0.05:
            self.elapsed = 0.0
            self.get_logger().info('still here')


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    for name, seconds in (('lookout', 1.0), ('keeper', 2.0)):
        executor.add_node(Reporter(name, seconds))
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
