import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


def report(node, text, period):
    while rclpy.ok():
        time.sleep(period)
        node.get_logger().info(text)


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    for name, text, period in [('lookout', 'I see the sea.', 1), ('keeper', 'The light burns.', 2)]:
        node = Node(name, namespace='harbour')
        executor.add_node(node)
        threading.Thread(target=report, args=(node, text, period), daemon=True).start()
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
