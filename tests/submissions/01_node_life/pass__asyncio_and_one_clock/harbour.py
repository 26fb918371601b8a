import asyncio

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class Lookout(Node):
    def __init__(self):
        super().__init__('lookout', namespace='harbour')
        self.create_timer(1.0, self.report)

    async def report(self):
        self.get_logger().info('nothing new')


class Keeper(Lookout.__base__):
    def __init__(self):
        super().__init__('keeper', namespace='harbour')
        self.silent = False
        self.create_timer(1.0, self.report)

    def report(self):
        # first second: report, second second: silent, and so on
        if not self.silent:
            self.get_logger().info('light checked')
        self.silent = not self.silent


async def spin(executor):
    while rclpy.ok():
        executor.spin_once(timeout_sec=0.05)
        await asyncio.sleep(0)


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    executor.add_node(Lookout())
    executor.add_node(Keeper())
    try:
        asyncio.run(spin(executor))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
