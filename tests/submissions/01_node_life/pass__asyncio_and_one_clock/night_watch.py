import asyncio

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class NightWatch(Node):
    def __init__(self):
        super().__init__('night_watch')
        self.bells = []
        self.create_timer(0.5, self.half_second)
        self.halves = 0

    async def half_second(self):
        self.halves += 1
        if self.halves % 2 == 0:
            await self.ring(self.halves // 2)

    async def ring(self, number):
        self.bells.append(number)
        if len(self.bells) % 5 == 0:
            self.get_logger().warning('watch %d' % number)
        else:
            self.get_logger().info('watch %d' % number)


async def main_loop(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.05)
        await asyncio.sleep(0)


def main(args=None):
    rclpy.init(args=args)
    try:
        asyncio.run(main_loop(NightWatch()))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
