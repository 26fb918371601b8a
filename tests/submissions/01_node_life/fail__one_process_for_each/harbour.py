import multiprocessing

import rclpy
from rclpy.node import Node


def run(name, seconds):
    rclpy.init()
    node = Node(name, namespace='harbour')
    node.create_timer(seconds, lambda: node.get_logger().info(f'{name} is awake'))
    rclpy.spin(node)


def main(args=None):
    other = multiprocessing.Process(target=run, args=('keeper', 2.0), daemon=True)
    other.start()
    run('lookout', 1.0)


if __name__ == '__main__':
    main()
