import asyncio
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, String


def inspect(picture):
    time.sleep(1.2)
    return picture.upper()


async def look(node, pictures, results):
    while True:
        picture = await pictures.get()
        found = await asyncio.to_thread(inspect, picture.data)
        results.publish(String(data=found))


async def spin(node):
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.01)


async def main():
    rclpy.init()
    node = Node('inspector')
    pictures = asyncio.Queue()
    alive = node.create_publisher(Empty, 'alive', 10)
    results = node.create_publisher(String, 'results', 10)
    node.create_subscription(String, 'pictures', pictures.put_nowait, 10)
    node.create_timer(0.5, lambda: alive.publish(Empty()))
    await asyncio.gather(spin(node), look(node, pictures, results))


asyncio.run(main())
