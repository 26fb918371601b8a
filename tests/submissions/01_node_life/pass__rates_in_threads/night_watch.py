import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


def watch(node):
    rate = node.create_rate(1)
    number = 1
    while rclpy.ok():
        rate.sleep()
        if number % 5 == 0:
            node.get_logger().warning(f'{number}. watch, wake up!')
        else:
            node.get_logger().info(f'{number}. watch')
        number += 1


def main(args=None):
    rclpy.init(args=args)
    node = Node('night_watch')
    threading.Thread(target=watch, args=(node,), daemon=True).start()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
