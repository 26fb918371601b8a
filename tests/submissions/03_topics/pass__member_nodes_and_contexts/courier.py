import asyncio

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


class Courier:
    def __init__(self):
        self.node = rclpy.create_node('courier')
        self.parcels = self.node.create_publisher(String, 'parcels', 10)

    async def spin(self):
        while rclpy.ok():
            rclpy.spin_once(self.node, timeout_sec=0.05)
            await asyncio.sleep(0)

    async def deliver(self):
        while not self.parcels.get_subscription_count():
            await asyncio.sleep(0.01)
        self.parcels.publish(String(data='for you'))

    async def run(self):
        await asyncio.gather(self.spin(), self.deliver())


def main(args=None):
    rclpy.init(args=args)
    try:
        asyncio.run(Courier().run())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
