import asyncio
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


async def watch(node):
    number = 0
    while rclpy.ok():
        await asyncio.sleep(1.0)
        number += 1
        if number % 5 == 0:
            node.get_logger().warning(f'{number}. watch, wake up!')
        else:
            node.get_logger().info(f'{number}. watch')


def main(args=None):
    rclpy.init(args=args)
    node = Node('night_watch')
    threading.Thread(target=asyncio.run, args=(watch(node),), daemon=True).start()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
