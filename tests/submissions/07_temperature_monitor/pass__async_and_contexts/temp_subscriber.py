import asyncio
from collections import defaultdict

import rclpy
from rclpy.node import Node
from temp_monitor_pkg.msg import Temperature


def unknown(value):
    raise LookupError('unknown unit')


CONVERT = defaultdict(
    lambda: unknown,
    Celsius=float,
    Fahrenheit=lambda value: 5.0 * (value - 32.0) / 9.0,
)


class Monitor(Node):
    def __init__(self):
        super().__init__('temperature_subscriber')
        self.create_subscription(Temperature, 'temperature_topic', self.on_message, 10)

    async def on_message(self, message):
        self.get_logger().info(f'{message.temperature_value:.3f} {message.unit}')
        try:
            hot = await self.is_hot(message)
        except LookupError as error:
            self.get_logger().error(f'{error}: {message.unit}')
        else:
            if hot:
                self.get_logger().warning('above 30 degrees')

    async def is_hot(self, message):
        return CONVERT[message.unit](message.temperature_value) > 30.0


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0.05)
        await asyncio.sleep(0)


def main(args=None):
    rclpy.init(args=args)
    asyncio.run(spin(Monitor()))


if __name__ == '__main__':
    main()
